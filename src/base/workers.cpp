// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/workers.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <latch>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/happens_before.h"
#include "knotreel/base/parallel.h"

namespace knotreel {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kGraph = 2;
constexpr std::chrono::milliseconds kPatience{100};

/// At the end of a scope, whether or not by an exception.
struct OpenAtEnd {
  std::latch& latch;
  ~OpenAtEnd() { latch.count_down(); }
};

/// That the system allows for so many threads besides this one, all at once.
void check_threads(int count) {
  std::latch done(1);
  std::vector<std::jthread> threads;  // joined when they are let go
  const OpenAtEnd end{done};
  try {
    for (int i = 0; i < count; ++i) threads.emplace_back([&] { done.wait(); });
  } catch (const std::system_error& e) {
    throw Error(ErrorKind::kInternal, "cannot make " + std::to_string(count) +
                                          " more threads: " + e.code().message() +
                                          "; allow for more (ulimit -u), or use fewer (--threads)");
  }
}

/// Gives each of so many threads something to do until all are there, or it has taken too long: all others
/// may be at work on something else.
void start(int threads) {
  std::atomic<int> arrived{0};
  const auto deadline = Clock::now() + kPatience;
  HappensBefore begun;
  HappensBefore ended;
  const auto meet = [&](int) {
    begun.acquire();
    ++arrived;
    while (arrived < threads && Clock::now() < deadline) std::this_thread::yield();
    ended.release();
  };
  oneapi::tbb::task_arena arena(threads);
  begun.release();
  arena.execute([&] { oneapi::tbb::parallel_for(0, threads, meet, oneapi::tbb::static_partitioner()); });
  ended.acquire();
}

}  // namespace

void ensure_workers(int threads) {
  static std::mutex mutex;
  static int ready = 1;
  // No arena of the usual size has more threads than there are cores; a flow graph has two, whatever the cap.
  const int cores = oneapi::tbb::info::default_concurrency();
  const int needed = std::max(kGraph, std::min(threads, cores));
  const std::lock_guard lock(mutex);
  if (needed <= ready) return;
  check_threads(needed - 1);
  // Under a lower cap none can be made, and oneTBB would say so on standard error.
  const int allowed = static_cast<int>(threads_allowed());
  start(std::min(needed, allowed));
  ready = std::min(needed, allowed);
}

}  // namespace knotreel
