#include "knotreel/pipeline/run.h"
#include "pipeline/nodes.h"
#include "pipeline/stages.h"

namespace knotreel::pipeline {

Summary run_graph(const Job& job) {
  Stages stages(job);
  HappensBefore decoded, planned, modelled, stored, encoded;
  flow::graph graph;
  flow::input_node<MessagePtr> decode(graph, source(decoded, [&] { return stages.decode(); }));
  flow::limiter_node<MessagePtr> limiter(graph, frames_in_flight(job.frames_in_flight));
  Node analyse(graph, flow::unlimited, isolated([&](Message& m) { stages.analyse(m); }));
  flow::sequencer_node<MessagePtr> analysed(graph, ByIndex{});
  Node plan(graph, flow::serial, in_turn(planned, [&](Message& m) { stages.plan(m); }));
  Node cold(graph, flow::unlimited, isolated([&](Message& m) { stages.cold(m); }));
  flow::sequencer_node<MessagePtr> prepared(graph, ByIndex{});
  Node model(graph, flow::serial, in_turn(modelled, [&](Message& m) { stages.model(m); }));
  Node documents(graph, flow::serial, in_turn(stored, [&](Message& m) { stages.documents(m); }));
  Node rasterize(graph, flow::unlimited, isolated([&](Message& m) { stages.rasterize(m); }));
  flow::sequencer_node<MessagePtr> drawn(graph, ByIndex{});
  LastNode encode(graph, flow::serial, last_in_turn(encoded, [&](Message& m) { stages.encode(m); }));
  flow::make_edge(decode, limiter);
  flow::make_edge(limiter, analyse);
  flow::make_edge(analyse, analysed);
  flow::make_edge(analysed, plan);
  flow::make_edge(plan, cold);
  flow::make_edge(cold, prepared);
  flow::make_edge(prepared, model);
  flow::make_edge(model, documents);
  flow::make_edge(documents, rasterize);
  flow::make_edge(rasterize, drawn);
  flow::make_edge(drawn, encode);
  flow::make_edge(encode, limiter.decrementer());
  decode.activate();
  graph.wait_for_all();
  decoded.acquire();  // it was asked once more after the last frame
  encoded.acquire();
  return stages.finish();
}

}  // namespace knotreel::pipeline
