// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "knotreel/base/happens_before.h"
#include "knotreel/base/parallel.h"
#include "pipeline/stretch.h"

/// The kinds of nodes that the graphs are made of.
namespace knotreel::pipeline {

namespace flow = oneapi::tbb::flow;

using Node = flow::function_node<MessagePtr, MessagePtr>;

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

struct ByIndex {
  std::size_t operator()(const MessagePtr& message) const { return static_cast<std::size_t>(message->index); }
};

/// A stage that takes one frame at a time, in order, whatever the order they come in. Frames need putting in
/// order even behind a stage like this: a node of oneTBB begins with the next message before it passes the
/// one that is done on.
/// @tparam Output  of the node: MessagePtr, or flow::continue_msg if nothing else is passed on.
template <class Output>
class InOrderTo {
 public:
  template <class Body>
  InOrderTo(flow::graph& graph, Body body)
      : sequencer_(graph, ByIndex{}),
        node_(graph, flow::serial, [this, body = isolated(body)](const MessagePtr& m) {
          turn_.acquire();
          body(m);
          turn_.release();
          if constexpr (std::is_same_v<Output, MessagePtr>) {
            return m;
          } else {
            return Output();
          }
        }) {
    flow::make_edge(sequencer_, node_);
  }

  flow::receiver<MessagePtr>& in() { return sequencer_; }
  flow::sender<Output>& out() { return node_; }
  /// To be called after a wait for the graph, before what the stage left behind is read.
  void acquire() { turn_.acquire(); }

 private:
  HappensBefore turn_;  ///< from one frame to the next
  flow::sequencer_node<MessagePtr> sequencer_;
  flow::function_node<MessagePtr, Output> node_;
};

using InOrder = InOrderTo<MessagePtr>;
using LastInOrder = InOrderTo<flow::continue_msg>;

/// A stage that takes the frames of each stretch one at a time, in order, and several stretches at once, if
/// these have turns of their own. Passes frames on in any order.
class InOrderWithinStretches {
 public:
  template <class Body>
  InOrderWithinStretches(flow::graph& graph, Body body)
      : node_(graph, flow::unlimited,
              [body = isolated(body)](const MessagePtr& m, Node::output_ports_type& ports) {
                work(m, body, std::get<0>(ports));
              }) {}

  flow::receiver<MessagePtr>& in() { return node_; }
  flow::sender<MessagePtr>& out() { return flow::output_port<0>(node_); }

 private:
  using Node = flow::multifunction_node<MessagePtr, std::tuple<MessagePtr>>;

  /// Works on this frame and those that wait for it, unless somebody else will.
  template <class Body, class Port>
  static void work(const MessagePtr& message, const Body& body, Port& port) {
    message->passed_on.acquire();
    const std::shared_ptr<Turns> turns = message->stretch->turns;
    std::unique_lock lock(turns->mutex);
    turns->waiting.emplace(message->index, message);
    if (turns->busy) return;
    turns->busy = true;
    for (auto first = turns->waiting.begin(); first != turns->waiting.end() && first->first == turns->next;
         first = turns->waiting.begin()) {
      const MessagePtr ready = std::move(first->second);
      turns->waiting.erase(first);
      ++turns->next;
      lock.unlock();
      port.try_put(body(ready));
      lock.lock();
    }
    turns->busy = false;
  }

  Node node_;
};

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

/// @param wanted as Job::frames_in_flight. @param width, height of a frame.
inline std::size_t frames_in_flight(int wanted, int width, int height) {
  constexpr std::size_t kLarge = 4'000'000;  // pixels: a frame takes dozens of bytes for each while it waits
  if (wanted > 0) return static_cast<std::size_t>(wanted);
  const bool is_large = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kLarge;
  return is_large ? threads_allowed() + 1 : 2 * threads_allowed() + 2;
}

}  // namespace knotreel::pipeline
