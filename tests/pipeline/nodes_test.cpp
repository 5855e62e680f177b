#include "pipeline/nodes.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace knotreel::pipeline
