// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel {
namespace {

TEST(ParallelFor, CallsEveryIndexOnce) {
  std::vector<std::atomic<int>> calls(1000);
  parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, AnExceptionOfABodyArrives) {
  EXPECT_THROW(parallel_for(100,
                            [](std::size_t i) {
                              if (i == 50) throw Error(ErrorKind::kInput, "fifty");
                            }),
               Error);
}

TEST(ParallelInvoke, CallsBothAndTheirLoops) {
  std::vector<int> a(100, 0);
  std::vector<int> b(100, 0);
  parallel_invoke([&] { parallel_for(a.size(), [&](std::size_t i) { a[i] += 1; }); },
                  [&] { parallel_for(b.size(), [&](std::size_t i) { b[i] += 2; }); });
  EXPECT_EQ(a, std::vector<int>(100, 1));
  EXPECT_EQ(b, std::vector<int>(100, 2));
}

TEST(ParallelInvoke, AnExceptionArrives) {
  EXPECT_THROW(parallel_invoke([] {}, [] { throw Error(ErrorKind::kInput, "second"); }), Error);
  EXPECT_THROW(parallel_invoke([] { throw Error(ErrorKind::kInput, "first"); }, [] {}), Error);
}

TEST(Urgent, LoopsCallEveryIndexOnceAndPassExceptionsOn) {
  const ThreadCap cap(3);
  const Urgent urgent;
  for (const std::size_t count : {0, 1, 2, 3, 1000}) {
    std::vector<std::atomic<int>> calls(count);
    parallel_for(count, [&](std::size_t i) { ++calls[i]; });
    for (const auto& times : calls) EXPECT_EQ(times, 1) << count;
  }
  std::vector<std::atomic<int>> calls(20 * 30);
  parallel_for(20, [&](std::size_t i) { parallel_for(30, [&](std::size_t j) { ++calls[30 * i + j]; }); });
  for (const auto& times : calls) EXPECT_EQ(times, 1);
  EXPECT_THROW(parallel_for(100,
                            [](std::size_t i) {
                              if (i == 50) throw Error(ErrorKind::kInput, "fifty");
                            }),
               Error);
}

TEST(Urgent, ThreadsAtWorkOnOtherLoopsHelp) {
  using std::chrono::milliseconds;
  const ThreadCap cap(2);
  std::atomic<bool> done = false;
  std::atomic<bool> begun = false;
  std::thread busy([&] {
    while (!done) {
      parallel_for(4, [&](std::size_t) {
        begun = true;
        std::this_thread::sleep_for(milliseconds(1));
      });
    }
  });
  while (!begun) std::this_thread::yield();
  std::mutex mutex;
  std::set<std::thread::id> threads;
  {
    const Urgent urgent;
    parallel_for(200, [&](std::size_t) {
      std::this_thread::sleep_for(milliseconds(1));
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
  }
  done = true;
  const std::thread::id helper = busy.get_id();
  busy.join();
  EXPECT_TRUE(threads.contains(helper));
  EXPECT_TRUE(threads.contains(std::this_thread::get_id()));
}

TEST(Urgent, ManyLoopsAtOnceEndWell) {
  const ThreadCap cap(4);
  std::vector<std::thread> owners;
  std::vector<std::atomic<int>> sums(4);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    owners.emplace_back([&sums, t] {
      std::optional<Urgent> urgent;
      if (t % 2 == 0) urgent.emplace();
      for (int round = 0; round < 200; ++round) {
        parallel_invoke([&] { parallel_for(10, [&](std::size_t) { ++sums[t]; }); },
                        [&] { parallel_for(20, [&](std::size_t) { ++sums[t]; }); });
      }
    });
  }
  for (std::thread& owner : owners) owner.join();
  for (const auto& sum : sums) EXPECT_EQ(sum, 200 * 30);
}

TEST(ThreadCap, OneMeansTheCallingThread) {
  const ThreadCap cap(1);
  std::set<std::thread::id> threads;  // no lock: one thread
  parallel_for(1000, [&](std::size_t) { threads.insert(std::this_thread::get_id()); });
  const Urgent urgent;
  parallel_for(1000, [&](std::size_t) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace knotreel
