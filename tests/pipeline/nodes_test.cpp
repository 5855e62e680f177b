// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <random>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::pipeline {
namespace {

/// What arrives at the end of some stages, one behind the other, that have next to nothing to do.
std::vector<std::uint64_t> order_at_the_end(std::uint64_t count) {
  std::vector<std::uint64_t> order;
  std::uint64_t next = 0;
  HappensBefore made;
  flow::graph graph;
  flow::input_node<MessagePtr> begin(graph, source(made, [&] {
                                       auto message = next < count ? std::make_shared<Message>() : nullptr;
                                       if (message) message->index = next++;
                                       return message;
                                     }));
  flow::limiter_node<MessagePtr> limiter(graph, 6);
  InOrder first(graph, [](Message&) {});
  InOrder second(graph, [](Message&) {});
  LastInOrder last(graph, [&](Message& m) { order.push_back(m.index); });
  flow::make_edge(begin, limiter);
  flow::make_edge(limiter, first.in());
  flow::make_edge(first.out(), second.in());
  flow::make_edge(second.out(), last.in());
  flow::make_edge(last.out(), limiter.decrementer());
  begin.activate();
  graph.wait_for_all();
  last.acquire();
  return order;
}

TEST(PipelineNodes, SerialStagesKeepTheOrder) {
  // Without sequencers between them, they do not about once in some thousand messages.
  constexpr std::uint64_t kCount = 100000;
  const ThreadCap cap(4);
  const std::vector<std::uint64_t> order = order_at_the_end(kCount);
  ASSERT_EQ(order.size(), kCount);
  for (std::uint64_t i = 0; i < kCount; ++i) ASSERT_EQ(order[i], i);
}

/// Messages of some stretches, in any order, through the stage for stretches.
template <class Body>
void work_through(const std::vector<MessagePtr>& messages, Body body) {
  flow::graph graph;
  InOrderWithinStretches stage(graph, body);
  flow::function_node<MessagePtr> end(graph, flow::unlimited, [](const MessagePtr&) {});
  flow::make_edge(stage.out(), end);
  for (const MessagePtr& m : messages) {
    m->passed_on.release();
    stage.in().try_put(m);
  }
  graph.wait_for_all();
}

std::vector<MessagePtr> messages_of(const std::vector<std::uint64_t>& begins, std::uint64_t end) {
  const Job job;
  std::vector<MessagePtr> messages;
  std::shared_ptr<Stretch> stretch;
  for (std::uint64_t i = 0; i < end; ++i) {
    if (std::find(begins.begin(), begins.end(), i) != begins.end())
      stretch = std::make_shared<Stretch>(i, job, track::Start::kCut);
    messages.push_back(std::make_shared<Message>());
    messages.back()->index = i;
    messages.back()->stretch = stretch;
  }
  return messages;
}

TEST(PipelineNodes, EachStretchIsWorkedOnInOrder) {
  const ThreadCap cap(4);
  const std::vector<std::uint64_t> begins{0, 1, 40, 300};
  std::mt19937_64 random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<MessagePtr> messages = messages_of(begins, 400);
    std::shuffle(messages.begin(), messages.end(), random);
    std::vector<std::uint64_t> expected = begins;  // next of each stretch; written by one at a time
    std::atomic<int> done = 0;
    work_through(messages, [&](Message& m) {
      const auto of = static_cast<std::size_t>(std::upper_bound(begins.begin(), begins.end(), m.index) -
                                               begins.begin() - 1);
      EXPECT_EQ(m.index, expected[of]++);
      ++done;
    });
    EXPECT_EQ(done, 400);
  }
}

TEST(PipelineNodes, StretchesAreWorkedOnAtTheSameTime) {
  const ThreadCap cap(4);
  std::promise<void> second_began;
  std::future<void> began = second_began.get_future();
  work_through(messages_of({0, 1}, 2), [&](Message& m) {
    if (m.index == 1) return second_began.set_value();
    EXPECT_EQ(began.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  });
}

TEST(PipelineNodes, StretchesThatShareTheirTurnsFollowEachOther) {
  const ThreadCap cap(4);
  std::mt19937_64 random(9);
  for (int round = 0; round < 50; ++round) {
    std::vector<MessagePtr> messages = messages_of({0, 1, 40, 300}, 400);
    for (const MessagePtr& m : messages) m->stretch->turns = messages.front()->stretch->turns;
    std::shuffle(messages.begin(), messages.end(), random);
    std::uint64_t next = 0;  // written by one at a time
    work_through(messages, [&](Message& m) { EXPECT_EQ(m.index, next++); });
    EXPECT_EQ(next, 400U);
  }
}

}  // namespace
}  // namespace knotreel::pipeline
