#pragma once

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <utility>

#include "knotreel/base/happens_before.h"
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
    message->passed_on.acquire();
    oneapi::tbb::this_task_arena::isolate([&] { body(*message); });
    message->passed_on.release();
    return message;
  };
}

/// The same for a serial stage.
/// @param turn  of the stage; must outlive the graph.
template <class Body>
auto in_turn(HappensBefore& turn, Body body) {
  return [&turn, body = isolated(body)](const MessagePtr& message) {
    turn.acquire();
    body(message);
    turn.release();
    return message;
  };
}

/// Takes frames as long as there are some.
template <class Next>
auto source(HappensBefore& turn, Next next) {
  return [&turn, next](oneapi::tbb::flow_control& control) {
    turn.acquire();
    MessagePtr message;
    oneapi::tbb::this_task_arena::isolate([&] { message = next(); });
    if (message) {
      message->passed_on.release();
    } else {
      control.stop();
    }
    turn.release();
    return message;
  };
}

/// The last, serial stage.
template <class Body>
auto last_in_turn(HappensBefore& turn, Body body) {
  return [body = in_turn(turn, body)](const MessagePtr& message) {
    body(message);
    return flow::continue_msg();
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
