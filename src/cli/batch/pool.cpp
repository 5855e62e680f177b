// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/pool.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel::cli::batch {
namespace {

constexpr std::chrono::milliseconds kTick{250};

/// Hands out the numbers of jobs and keeps the first exception.
class Counter {
 public:
  explicit Counter(std::size_t count) : count_(count) {}

  std::optional<std::size_t> next() {
    const std::lock_guard lock(mutex_);
    if (failure_ || next_ == count_) return std::nullopt;
    return next_++;
  }

  void fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
  }

  /// For when all workers are gone.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::size_t count_;
  std::size_t next_ = 0;
  std::exception_ptr failure_;
};

/// Waits for a number of threads to say that they have ended.
class Finish {
 public:
  explicit Finish(int running) : running_(running) {}

  void one() {
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_all();
  }

  bool wait() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kTick, [&] { return running_ == 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int running_;
};

}  // namespace

Room::Room(int workers, int threads) : threads_(threads), working_(workers) {
  share_threads();
}

Room::Stay Room::enter(bool large) {
  std::unique_lock lock(mutex_);
  --working_;
  large_waiting_ += large ? 1 : 0;
  changed_.wait(lock, [&] { return large ? inside_ == 0 : !alone_ && large_waiting_ == 0; });
  large_waiting_ -= large ? 1 : 0;
  ++working_;
  ++inside_;
  alone_ = large;
  share_threads();
  return Stay(*this);
}

void Room::leave() {
  const std::lock_guard lock(mutex_);
  --inside_;
  alone_ = false;
  changed_.notify_all();
}

void Room::retire() {
  const std::lock_guard lock(mutex_);
  --working_;
  share_threads();
}

void Room::share_threads() {
  // Each worker is a thread besides those of the loops, of which one is the worker itself.
  const int cap = std::max(1, threads_ - std::max(working_, 1) + 1);
  cap_.reset();
  cap_.emplace(cap);
}

void run_jobs(std::size_t count, const Crew& crew, const std::function<void(std::size_t, Room&)>& job,
              const std::function<void()>& tick) {
  const ThreadCap most(crew.threads);  // what can go wrong with threads is to go wrong here
  Room room(crew.workers, crew.threads);
  Counter counter(count);
  Finish finish(crew.workers);
  const auto work = [&] {
    try {
      while (const auto i = counter.next()) job(*i, room);
    } catch (...) {
      counter.fail(std::current_exception());
    }
    room.retire();
    finish.one();
  };
  std::vector<std::jthread> workers;
  for (int i = 0; i < crew.workers; ++i) {
    try {
      workers.emplace_back(work);
    } catch (const std::system_error& e) {
      if (workers.empty()) throw Error(ErrorKind::kInternal, "cannot make a thread: " + e.code().message());
      room.retire();  // the others do without
      finish.one();
    }
  }
  while (!finish.wait()) tick();
  workers.clear();
  counter.rethrow();
}

}  // namespace knotreel::cli::batch
