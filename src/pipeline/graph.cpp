#include "knotreel/pipeline/run.h"
#include "pipeline/nodes.h"
#include "pipeline/stages.h"

namespace knotreel::pipeline {

Summary run_graph(const Job& job) {
  Stages stages(job);
  flow::graph graph;
  flow::input_node<MessagePtr> decode(graph, source([&] { return stages.decode(); }));
  flow::limiter_node<MessagePtr> limiter(graph, frames_in_flight(job.frames_in_flight));
  Node analyse(graph, flow::unlimited, isolated([&](Message& m) { stages.analyse(m); }));
  flow::sequencer_node<MessagePtr> in_order(graph, ByIndex{});
  Node model(graph, flow::serial, isolated([&](Message& m) { stages.model(m); }));
  Node documents(graph, flow::serial, isolated([&](Message& m) { stages.documents(m); }));
  Node rasterize(graph, flow::unlimited, isolated([&](Message& m) { stages.rasterize(m); }));
  flow::sequencer_node<MessagePtr> in_order_again(graph, ByIndex{});
  const auto body = isolated([&](Message& m) { stages.encode(m); });
  LastNode encode(graph, flow::serial, [body](const MessagePtr& m) {
    body(m);
    return flow::continue_msg();
  });
  flow::make_edge(decode, limiter);
  flow::make_edge(limiter, analyse);
  flow::make_edge(analyse, in_order);
  flow::make_edge(in_order, model);
  flow::make_edge(model, documents);
  flow::make_edge(documents, rasterize);
  flow::make_edge(rasterize, in_order_again);
  flow::make_edge(in_order_again, encode);
  flow::make_edge(encode, limiter.decrementer());
  decode.activate();
  graph.wait_for_all();
  return stages.finish();
}

}  // namespace knotreel::pipeline
