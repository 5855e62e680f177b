#include "knotreel/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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

TEST(ThreadCap, OneMeansTheCallingThread) {
  const ThreadCap cap(1);
  std::set<std::thread::id> threads;  // no lock: one thread
  parallel_for(1000, [&](std::size_t) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace knotreel
