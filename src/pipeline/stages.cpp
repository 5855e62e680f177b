// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stages.h"

#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/hidden_colours.h"
#include "knotreel/motion/luma.h"
#include "knotreel/pipeline/sequence.h"
#include "knotreel/track/curve_error.h"
#include "pipeline/required.h"
#include "pipeline/split_folder.h"
#include "pipeline/timed.h"

namespace knotreel::pipeline {
namespace {

/// As many are busy with one group of frames alone: another one beside it would only take memory, a sixth of
/// all at 640x360.
constexpr std::size_t kThreadsOfAGroup = 2;

/// The first frame is what somebody waits for; from then on, frames come as fast as they can.
bool is_awaited(const Message& message) {
  return message.index == 0;
}

}  // namespace

Stages::Stages(const Job& job)
    : job_(job),
      info_(sequence_info(required(job.reader).info(), job.source, job.cold.degree)),
      output_(job.video, job.reader->info(), job.reader, job.on_frame,
              job.ssim ? image::Figures::kAll : image::Figures::kWithoutSsim),
      beside_(job),
      document_(job.document, info_),
      groups_(job.tracking),
      groups_at_once_(!job.tracking.warm_start || threads_allowed() > kThreadsOfAGroup) {
  make_split_folder(job.split_folder);
}

MessagePtr Stages::decode() {
  if (failure_.any() || stopped_) return nullptr;
  stopped_ = job_.stop && job_.stop();
  if (stopped_) return nullptr;
  auto message = std::make_shared<Message>();
  message->index = decoded_;
  bool more = false;
  timed(failure_, "decode", *message, [&] { more = job_.reader->next(message->frame); });
  if (!more) return nullptr;
  ++decoded_;
  message->row.index = message->index;
  message->row.pts = message->frame.pts;
  message->picture =
      std::make_shared<const image::Image>(image::extend_seen_colours(std::move(message->frame.image)));
  message->before = std::exchange(before_, message->picture);
  return message;
}

void Stages::analyse(Message& message) {
  timed(failure_, "analyse", message, [&] {
    if (message.before && job_.tracking.warm_start) {
      message.motion = std::make_unique<track::Motion>(
          track::motion_between(*message.before, *message.picture, job_.flow));
      message.same_picture = message.motion->repeated;
    }
    message.before.reset();
  });
}

void Stages::plan(Message& message) {
  const track::Start start = groups_.next(message.motion.get());
  message.starts_group = start != track::Start::kWarm;
  // Where the others start depends on what drifts.
  if (start == track::Start::kFirst || start == track::Start::kCut)
    stretch_ = std::make_shared<Stretch>(message.index, job_, start,
                                         groups_at_once_ || !stretch_ ? nullptr : stretch_->turns);
  message.stretch = stretch_;
}

void Stages::ahead(Message& message) {
  if (message.starts_group) {
    if (groups_at_once_) cold(message);
    return;
  }
  const track::Tracker& tracker = message.stretch->tracker;
  const track::Drawing how = tracker.drawing();
  if (how == track::Drawing::kNone || message.same_picture) return;
  timed(failure_, "curves", message, [&] {
    message.ahead.curves =
        track::find_drawn_curves(*message.picture, *job_.tracking.drawn, how, tracker.known_drawings());
  });
}

void Stages::cold(Message& message) {
  timed(failure_, "cold", message, [&] {
    const Urgent urgent(is_awaited(message));
    const auto observer = job_.watch.cold ? job_.watch.cold(message.index) : vectorize::Observer();
    message.ahead.cold =
        track::make_cold_frame(*message.picture,
                               {job_.cold, job_.tracking.drawn.get(), job_.tracking.dense.get(),
                                job_.tracking.dense_film.get(), job_.tracking.cramped.get()},
                               job_.tracking.colour_step, observer);
  });
}

void Stages::model(Message& message) {
  const Urgent urgent;  // models follow each other
  // Here it is known what has drifted since this was planned.
  if (!groups_at_once_ && message.stretch->tracker.starts_group(message.motion.get())) cold(message);
  timed(failure_, "model", message, [&] {
    track::FrameReport report;
    track::Tracker& tracker = message.stretch->tracker;
    message.model = tracker.next(*message.picture, message.motion.get(), &report, std::move(message.ahead));
    message.surface = tracker.surface();
    message.changed = tracker.changed_tiles();
    message.motion.reset();
    message.stretch.reset();
    message.model.frame = message.index;
    message.model.pts = message.frame.pts;
    message.row.start = track::to_string(report.start);
    message.row.knots = report.knots;
    message.row.control_points = report.control_points;
    message.row.survival = report.survival;
    message.row.wanted_share = static_cast<double>(report.wanted_control_points) /
                               static_cast<double>(message.picture->pixel_count());
    message.row.features_dropped = report.features_dropped;
    message.row.changes = std::move(report.changes);
    message.row.model_milliseconds = std::move(report.milliseconds);
  });
}

void Stages::documents(Message& message) {
  timed(failure_, "documents", message, [&] {
    if (!job_.split_folder.empty()) write_single(message);
    const std::uint64_t before = document_.bytes();
    document::FrameModel stored = document_.append(message.model);
    if (stored.space != message.model.space || stored.displacement != message.model.displacement ||
        stored.colour != message.model.colour)
      message.surface.reset();
    if (!message.surface || !is_known_) message.changed.clear();
    is_known_ = message.surface != nullptr;
    message.repeats = message.same_picture && same_surface(stored, stored_);
    last_ = {stored.pts, message.index > 0 ? stored.pts - last_.pts : 0, message.frame.duration};
    stored_ = stored;
    message.model = std::move(stored);
    message.row.bytes = document_.bytes() - before;
  });
}

void Stages::write_single(const Message& message) {
  document::FrameModel model = message.model;
  model.keyframe = true;
  DocumentSink single(single_path(job_.split_folder, message.index), info_, {.rename_knots = true});
  single.append(model);
  single.finish();
}

void Stages::rasterize(Message& message) {
  timed(failure_, "rasterize", message, [&] {
    const Urgent urgent(is_awaited(message));
    if (!message.repeats) draw(message);
    if (job_.watch.stored) job_.watch.stored(message.index, *message.picture, message.model);
    message.model = {};
    message.surface.reset();
  });
}

void Stages::draw(Message& message) const {
  const auto basis =
      message.surface ? message.surface->basis : std::make_shared<const spline::Basis>(message.model.space);
  output_.draw(message, basis);
  message.row.meg = track::curve_error(message.model, *basis, motion::luma_of(*message.picture));
  beside_.compose(message);
}

void Stages::encode(Message& message) {
  timed(failure_, "encode", message, [&] {
    const Urgent urgent(is_awaited(message));
    output_.write(message);
    beside_.write(message);
    message.picture.reset();
  });
  timed(failure_, "report", message, [&] { output_.sum_up(message.row); });
}

Summary Stages::finish() {
  failure_.rethrow();
  if (decoded_ == 0) {
    if (stopped_) throw Error(ErrorKind::kInterrupted, "interrupted before the first frame");
    throw Error(ErrorKind::kInput, "'" + job_.source + "' has no frame that can be decoded");
  }
  output_.write_packets(job_.reader->remaining_packets());
  document_.finish(duration_to_tell(info_, last_));
  beside_.finish();
  Summary summary = output_.finish();
  summary.document_bytes = document_.bytes();
  summary.stopped = stopped_;
  return summary;
}

}  // namespace knotreel::pipeline
