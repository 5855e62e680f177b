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

TEST(ThreadCap, OneMeansTheCallingThread) {
  const ThreadCap cap(1);
  std::set<std::thread::id> threads;  // no lock: one thread
  parallel_for(1000, [&](std::size_t) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace knotreel
