// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <utility>

#include "base/shared_loop.h"
#include "base/workers.h"
#include "knotreel/base/happens_before.h"

namespace knotreel {

ThreadCap::ThreadCap(int threads) : impl_(nullptr) {
  const int cap = threads > 0 ? threads : oneapi::tbb::info::default_concurrency();
  ensure_workers(cap);
  impl_ = new oneapi::tbb::global_control(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(cap));
}

ThreadCap::~ThreadCap() {
  delete static_cast<oneapi::tbb::global_control*>(impl_);
}

std::size_t threads_allowed() {
  using Control = oneapi::tbb::global_control;
  return Control::active_value(Control::max_allowed_parallelism);
}

namespace {

/// At the end of a scope, whether or not by an exception.
struct ReleaseAtEnd {
  HappensBefore& order;
  ~ReleaseAtEnd() { order.release(); }
};
struct AcquireAtEnd {
  HappensBefore& order;
  ~AcquireAtEnd() { order.acquire(); }
};

/// Idle threads come by a task of oneTBB, busy ones see the loop on the board.
void run_urgently(std::size_t count, const std::function<void(std::size_t)>& body) {
  const std::size_t threads = std::min(threads_allowed(), count);
  SharedLoop loop(count, threads, body);
  HappensBefore begun;
  HappensBefore ended;
  const AcquireAtEnd end{ended};
  begun.release();
  // Isolated: to wait for helpers must not mean to begin with anything else.
  oneapi::tbb::this_task_arena::isolate([&] {
    oneapi::tbb::task_group helpers;
    for (std::size_t i = 1; i < threads; ++i) {
      helpers.run([&] {
        begun.acquire();
        const ReleaseAtEnd done{ended};
        loop.help();
      });
    }
    try {
      loop.run();
    } catch (...) {
      helpers.wait();
      throw;
    }
    helpers.wait();
  });
}

void run_plainly(std::size_t count, const std::function<void(std::size_t)>& body) {
  HappensBefore begun;
  HappensBefore ended;
  const AcquireAtEnd end{ended};
  begun.release();
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    begun.acquire();
    {
      const ReleaseAtEnd done{ended};
      body(i);
    }
    if (!urgent_here()) SharedLoop::help_all();
  });
}

}  // namespace

Urgent::Urgent(bool really) : before_(std::exchange(urgent_here(), really || urgent_here())) {}
Urgent::~Urgent() {
  urgent_here() = before_;
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (urgent_here() && count > 1 && threads_allowed() > 1) {
    run_urgently(count, body);
  } else {
    run_plainly(count, body);
  }
}

void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second) {
  parallel_for(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

}  // namespace knotreel
