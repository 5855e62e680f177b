// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#if defined(__SANITIZE_THREAD__)  // GCC
#define KNOTREEL_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)  // Clang
#define KNOTREEL_THREAD_SANITIZER 1
#endif
#endif

#if defined(KNOTREEL_THREAD_SANITIZER)
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace knotreel {

/// An order between threads that oneTBB makes: what happened before release() has happened for whoever calls
/// acquire() later. It only tells ThreadSanitizer, which cannot see into that library, and costs nothing
/// otherwise; it orders nothing by itself.
class HappensBefore {
 public:
#if defined(KNOTREEL_THREAD_SANITIZER)
  void release() {
    __tsan_release(&place_);
  }
  void acquire() {
    __tsan_acquire(&place_);
  }
#else
  void release() {}
  void acquire() {}
#endif

 private:
  [[maybe_unused]] char place_ = 0;
};

}  // namespace knotreel
