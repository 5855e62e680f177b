// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/shared_loop.h"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

namespace knotreel {

namespace {

// Chunks per thread: few enough to cost nothing, enough for threads to end together.
constexpr std::size_t kChunks = 16;

}  // namespace

struct SharedLoop::Board {
  std::atomic<int> count{0};  ///< of loops
  std::mutex mutex;
  std::vector<SharedLoop*> loops;
};

SharedLoop::Board& SharedLoop::board() {
  static Board board;
  return board;
}

bool& urgent_here() {
  thread_local bool urgent = false;
  return urgent;
}

SharedLoop::SharedLoop(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& body)
    : count_(count), chunk_(std::max<std::size_t>(1, count / (kChunks * threads))), body_(body) {}

void SharedLoop::work() {
  for (;;) {
    const std::size_t begin = next_.fetch_add(chunk_, std::memory_order_acq_rel);
    if (begin >= count_) return;
    try {
      for (std::size_t i = begin; i < std::min(begin + chunk_, count_); ++i) body_(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      next_.store(count_, std::memory_order_release);
    }
  }
}

void SharedLoop::help() {
  helpers_.fetch_add(1, std::memory_order_acq_rel);
  const bool before = std::exchange(urgent_here(), true);
  work();
  urgent_here() = before;
  helpers_.fetch_sub(1, std::memory_order_acq_rel);
}

void SharedLoop::run() {
  Board& all = board();
  {
    const std::lock_guard lock(all.mutex);
    all.loops.push_back(this);
    all.count.fetch_add(1, std::memory_order_release);
  }
  work();
  {
    const std::lock_guard lock(all.mutex);
    std::erase(all.loops, this);
    all.count.fetch_sub(1, std::memory_order_release);
  }
  while (helpers_.load(std::memory_order_acquire) > 0) {
    help_all();  // the calls of others may have loops of their own
    std::this_thread::yield();
  }
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void SharedLoop::help_all() {
  Board& all = board();
  while (all.count.load(std::memory_order_acquire) > 0) {
    SharedLoop* loop = nullptr;
    {
      const std::lock_guard lock(all.mutex);
      const auto found = std::ranges::find_if(all.loops, [](const SharedLoop* l) { return l->has_left(); });
      if (found == all.loops.end()) return;
      loop = *found;
      loop->helpers_.fetch_add(1, std::memory_order_acq_rel);
    }
    loop->help();
    loop->helpers_.fetch_sub(1, std::memory_order_acq_rel);
  }
}

}  // namespace knotreel
