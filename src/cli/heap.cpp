// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/heap.h"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <thread>

namespace knotreel::cli {

namespace {

#ifdef __GLIBC__

/// Large arrays come and go with every fit; without this, glibc returns each to the system and has its pages
/// cleared again for the next one, which takes a tenth of the time.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  // Arrays are passed on from thread to thread. Each arena keeps what was freed in it, whoever needs memory
  // next: one for each of two threads takes a sixth more than one for both, for no time that can be measured.
  constexpr int kThreadsPerArena = 4;
  mallopt(M_ARENA_MAX, std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / kThreadsPerArena));
}

#ifdef MADV_HUGEPAGE

constexpr std::size_t kReserve = std::size_t{768} << 20;  // bytes: 1280x720, and less than is trimmed
constexpr int kDefaultPad = 128 << 10;                    // of glibc

bool is_limited() {
  const auto limited = [](auto resource) {
    rlimit limit{};
    return ::getrlimit(resource, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
  };
  return limited(RLIMIT_AS) || limited(RLIMIT_DATA);
}

/// The heap gets room to grow in huge pages (addresses only: memory is taken when it is used). With small
/// ones, the 40,000 page faults until it has its size take a twentieth of the time of a short clip, and up to
/// a fifth of that of its first frame, where the machine is a virtual one.
void use_huge_pages() {
  if (is_limited()) return;  // addresses are scarce then
  const auto end_of_heap = [] { return reinterpret_cast<std::uintptr_t>(::sbrk(0)); };
  const std::uintptr_t begin = end_of_heap();
  mallopt(M_TOP_PAD, static_cast<int>(kReserve));
  void* volatile grown = std::malloc(std::size_t{1} << 20);  // more than there is room for
  std::free(grown);
  mallopt(M_TOP_PAD, kDefaultPad);
  const std::uintptr_t end = end_of_heap();
  if (end < begin + kReserve) return;  // another allocator, or no room there
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t first = (begin + page - 1) / page * page;
  ::madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);  // advice: it may fail
}

#endif
#endif

}  // namespace

void set_up_heap() {
#ifdef __GLIBC__
  keep_freed_memory();
#ifdef MADV_HUGEPAGE
  use_huge_pages();
#endif
#endif
}

}  // namespace knotreel::cli
