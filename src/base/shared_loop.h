// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

namespace knotreel {

/// A loop that any thread may help with while it is on the board.
class SharedLoop {
 public:
  /// @param threads that may come to help, with the one that owns the loop.
  SharedLoop(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& body);

  /// Puts the loop on the board, and takes part until no call is left to begin; then takes it off and waits
  /// for those of others, helping with what is on the board meanwhile. By the owner, once.
  /// @throws what a body threw.
  void run();

  /// Takes part until no call is left to begin. The loop must outlive this.
  void help();

  /// Takes part in loops on the board until none has a call left to begin.
  static void help_all();

 private:
  struct Board;
  static Board& board();

  bool has_left() const { return next_.load(std::memory_order_relaxed) < count_; }
  void work();

  std::size_t count_;
  std::size_t chunk_;  ///< calls that are begun together
  const std::function<void(std::size_t)>& body_;
  std::atomic<std::size_t> next_{0};
  std::atomic<int> helpers_{0};
  std::mutex mutex_;  ///< of what follows
  std::exception_ptr failure_;
};

/// Whether the loops of this thread are urgent.
bool& urgent_here();

}  // namespace knotreel
