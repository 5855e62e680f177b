// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>

namespace knotreel::pipeline {

/// The first exception of any stage. Once there is one, stages pass messages on without work, so that the
/// graph runs empty and every frame number arrives everywhere. Thread safe.
class FirstFailure {
 public:
  bool any() const { return failed_.load(std::memory_order_acquire); }

  /// Keeps the exception that is being handled, unless there is one.
  void keep(std::uint64_t frame, const char* stage);

  /// @throws what was kept, if anything, with "frame N, stage: " in front; an Error keeps its kind.
  void rethrow() const;

 private:
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr exception_;
  std::string where_;
};

}  // namespace knotreel::pipeline
