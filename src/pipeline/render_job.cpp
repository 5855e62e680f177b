// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/render_job.h"

#include <array>
#include <optional>

#include "knotreel/spline/space.h"
#include "knotreel/track/between.h"
#include "pipeline/copied_packets.h"
#include "pipeline/nodes.h"
#include "pipeline/schedule.h"
#include "pipeline/timed.h"

namespace knotreel::pipeline {
namespace {

/// The stages of a RenderJob; as Stages.
class RenderStages {
 public:
  explicit RenderStages(const RenderJob& job)
      : job_(job),
        schedule_(job),
        copied_(job, schedule_),
        output_(job.video, schedule_.stream(), job.copied, job.on_frame, image::Figures::kWithoutSsim) {}

  MessagePtr read() {
    if (failure_.any() || stopped_) return nullptr;
    const std::optional<Showing> next = schedule_.next();
    if (!next) return nullptr;
    stopped_ = job_.stop && job_.stop();
    if (stopped_) return nullptr;
    const Showing& showing = *next;
    auto message = std::make_shared<Message>();
    message->index = next_++;
    timed(failure_, "read", *message, [&] {
      message->model = read(showing.frame);
      if (showing.share > 0) message->next = read(showing.frame + 1);
      message->frame.packets = copied_.until_end_of(showing);
    });
    if (failure_.any()) return nullptr;
    message->share = showing.share;
    message->repeats = showing.share == 0 && before_ && same_surface(message->model, *before_);
    before_.reset();
    if (showing.share == 0) before_ = message->model;
    message->frame.pts = showing.pts;
    message->frame.duration = showing.duration;
    FrameRow& row = message->row;
    row.index = message->index;
    row.pts = showing.pts;
    row.knots = message->model.space->mesh().knots.size();
    row.control_points = message->model.space->function_count();
    row.bytes = job_.reader->record(showing.frame).bytes;
    return message;
  }

  void rasterize(Message& message) {
    timed(failure_, "rasterize", message, [&] {
      if (message.share > 0) message.model = track::between(message.model, message.next, message.share);
      message.next = {};
      if (!message.repeats) {
        output_.draw(message, std::make_shared<const spline::Basis>(message.model.space));
      }
      message.model = {};
    });
  }

  void encode(Message& message) {
    timed(failure_, "encode", message, [&] { output_.write(message); });
    timed(failure_, "report", message, [&] { output_.sum_up(message.row); });
  }

  Summary finish() {
    failure_.rethrow();
    if (!stopped_) output_.write_packets(copied_.rest());
    Summary summary = output_.finish();
    summary.document_bytes = job_.reader->file_bytes();
    summary.stopped = stopped_;
    return summary;
  }

 private:
  /// The same two frames may be asked for again and again; going back in a document is dear.
  const document::FrameModel& read(std::size_t frame) {
    Kept& kept = kept_[frame % kept_.size()];
    if (kept.frame != frame) kept = {frame, job_.reader->read(frame)};
    return kept.model;
  }

  struct Kept {
    std::optional<std::size_t> frame;
    document::FrameModel model;
  };

  const RenderJob& job_;
  std::array<Kept, 2> kept_;
  Schedule schedule_;
  CopiedPackets copied_;
  PictureOutput output_;
  FirstFailure failure_;
  std::optional<document::FrameModel> before_;  ///< the last frame, if it was shown as it is
  std::size_t next_ = 0;
  bool stopped_ = false;
};

}  // namespace

std::uint64_t frame_count(const RenderJob& job) {
  return Schedule(job).count();
}

Summary run_render(const RenderJob& job) {
  RenderStages stages(job);
  HappensBefore decoded;
  flow::graph graph;
  flow::input_node<MessagePtr> read(graph, source(decoded, [&] { return stages.read(); }));
  flow::limiter_node<MessagePtr> limiter(
      graph, frames_in_flight(job.frames_in_flight, job.video.width, job.video.height));
  Node rasterize(graph, flow::unlimited, isolated([&](Message& m) { stages.rasterize(m); }));
  LastInOrder encode(graph, [&](Message& m) { stages.encode(m); });
  flow::make_edge(read, limiter);
  flow::make_edge(limiter, rasterize);
  flow::make_edge(rasterize, encode.in());
  flow::make_edge(encode.out(), limiter.decrementer());
  read.activate();
  graph.wait_for_all();
  decoded.acquire();  // it was asked once more after the last frame
  encode.acquire();
  return stages.finish();
}

}  // namespace knotreel::pipeline
