#pragma once

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <utility>

#include "pipeline/message.h"

/// The kinds of nodes that the graphs are made of.
namespace knotreel::pipeline {

namespace flow = oneapi::tbb::flow;

using Node = flow::function_node<MessagePtr, MessagePtr>;
using LastNode = flow::function_node<MessagePtr, flow::continue_msg>;

/// A body whose inner loops take up no other frame while they wait: a serial stage would be late, and a
/// stage could find itself inside another one.
template <class Body>
auto isolated(Body body) {
  return [body](const MessagePtr& message) {
    oneapi::tbb::this_task_arena::isolate([&] { body(*message); });
    return message;
  };
}

/// Takes frames as long as there are some.
template <class Next>
auto source(Next next) {
  return [next](oneapi::tbb::flow_control& control) {
    MessagePtr message;
    oneapi::tbb::this_task_arena::isolate([&] { message = next(); });
    if (!message) control.stop();
    return message;
  };
}

struct ByIndex {
  std::size_t operator()(const MessagePtr& message) const { return static_cast<std::size_t>(message->index); }
};

/// @param wanted as Job::frames_in_flight.
inline std::size_t frames_in_flight(int wanted) {
  if (wanted > 0) return static_cast<std::size_t>(wanted);
  using oneapi::tbb::global_control;
  return 2 * global_control::active_value(global_control::max_allowed_parallelism) + 2;
}

}  // namespace knotreel::pipeline
