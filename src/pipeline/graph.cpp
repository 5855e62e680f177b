// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/run.h"
#include "pipeline/nodes.h"
#include "pipeline/stages.h"

namespace knotreel::pipeline {

Summary run_graph(const Job& job) {
  Stages stages(job);
  HappensBefore decoded;
  flow::graph graph;
  flow::input_node<MessagePtr> decode(graph, source(decoded, [&] { return stages.decode(); }));
  const video::StreamInfo& info = job.reader->info();
  flow::limiter_node<MessagePtr> limiter(graph,
                                         frames_in_flight(job.frames_in_flight, info.width, info.height));
  Node analyse(graph, flow::unlimited, isolated([&](Message& m) { stages.analyse(m); }));
  InOrder plan(graph, [&](Message& m) { stages.plan(m); });
  Node ahead(graph, flow::unlimited, isolated([&](Message& m) { stages.ahead(m); }));
  InOrderWithinStretches model(graph, [&](Message& m) { stages.model(m); });
  InOrder documents(graph, [&](Message& m) { stages.documents(m); });
  Node rasterize(graph, flow::unlimited, isolated([&](Message& m) { stages.rasterize(m); }));
  LastInOrder encode(graph, [&](Message& m) { stages.encode(m); });
  flow::make_edge(decode, limiter);
  flow::make_edge(limiter, analyse);
  flow::make_edge(analyse, plan.in());
  flow::make_edge(plan.out(), ahead);
  flow::make_edge(ahead, model.in());
  flow::make_edge(model.out(), documents.in());
  flow::make_edge(documents.out(), rasterize);
  flow::make_edge(rasterize, encode.in());
  flow::make_edge(encode.out(), limiter.decrementer());
  decode.activate();
  graph.wait_for_all();
  decoded.acquire();  // it was asked once more after the last frame
  encode.acquire();
  return stages.finish();
}

}  // namespace knotreel::pipeline
