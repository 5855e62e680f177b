// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schedule.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"
#include "knotreel/pipeline/sequence.h"
#include "pipeline/required.h"

namespace knotreel::pipeline {
namespace {

std::size_t checked_last(const RenderJob& job) {
  const std::size_t count = job.reader->frame_count();
  if (!job.last && job.first >= count) {
    throw Error(ErrorKind::kInvalidArgument, "there is no frame " + std::to_string(job.first) +
                                                 ": the document has " + std::to_string(count) +
                                                 ", counted from 0");
  }
  const std::size_t last = job.last.value_or(count - 1);
  if (job.first > last || last >= count) {
    throw Error(ErrorKind::kInvalidArgument, "there are no frames " + std::to_string(job.first) + "-" +
                                                 std::to_string(last) + ": the document has " +
                                                 std::to_string(count) + ", counted from 0");
  }
  return last;
}

/// A video rendered from its middle on starts at zero all the same.
std::vector<Showing> as_stored(const RenderJob& job, std::size_t last) {
  std::vector<Showing> frames;
  const std::int64_t shift = job.first > 0 ? job.reader->record(job.first).pts : 0;
  for (std::size_t i = job.first; i <= last; ++i) {
    const std::int64_t pts = job.reader->record(i).pts;
    const bool ends = i + 1 == job.reader->frame_count();
    frames.push_back(
        {i, 0, pts - shift, ends ? last_duration(*job.reader) : job.reader->record(i + 1).pts - pts});
  }
  return frames;
}

/// How far a time is from one frame to the next. Nothing lies between the last frame of a group and the next
/// group: it stays until that begins.
double share_between(const document::Reader& reader, const std::vector<Showing>& stored, std::size_t i,
                     double time) {
  if (i + 1 == stored.size() || reader.record(stored[i + 1].frame).keyframe) return 0;
  const double begin = static_cast<double>(stored[i].pts);
  return std::max(0.0, (time - begin) / (static_cast<double>(stored[i + 1].pts) - begin));
}

/// Of a time that stored frames take, in ticks of the document.
std::int64_t frames_in(double length, double ticks_per_frame) {
  const double count = length / ticks_per_frame;
  if (!(count <= static_cast<double>(kMaxTicks)))
    throw Error(ErrorKind::kInvalidArgument, "at this rate there are more than 2^53 frames");
  return std::max(1LL, std::llround(count));
}

}  // namespace

Schedule::Schedule(const RenderJob& job)
    : reader_(&required(job.reader)),
      stored_(as_stored(job, checked_last(job))),
      stream_(stream_info(reader_->info())) {
  count_ = static_cast<std::int64_t>(stored_.size());
  if (job.first > 0) stream_.start = 0;
  if (job.first > 0 || job.rate.known()) origin_ = reader_->record(job.first).pts;
  if (!job.rate.known()) return;
  ticks_per_frame_ = 1 / (job.rate.value() * stream_.time_base.value());
  const std::int64_t length = stored_.back().pts + stored_.back().duration - stored_.front().pts;
  count_ = frames_in(static_cast<double>(length), ticks_per_frame_);
  stream_.frame_rate = job.rate;
  stream_.time_base = {job.rate.den, job.rate.num};
  stream_.start = 0;
}

std::int64_t Schedule::begin() const {
  return ticks_per_frame_ > 0 ? 0 : stored_.front().pts;
}
std::int64_t Schedule::end() const {
  return ticks_per_frame_ > 0 ? count_ : stored_.back().pts + stored_.back().duration;
}

std::optional<Showing> Schedule::next() {
  if (next_ == count_) return std::nullopt;
  const std::int64_t number = next_++;
  return ticks_per_frame_ > 0 ? resampled(number) : stored_[static_cast<std::size_t>(number)];
}

/// What is shown at a tick of another rate. Ticks in order.
Showing Schedule::resampled(std::int64_t tick) {
  // Times that are meant to be those of a frame are so but for rounding.
  const double slack = 1e-6 * ticks_per_frame_;
  const double time =
      static_cast<double>(stored_.front().pts) + static_cast<double>(tick) * ticks_per_frame_ + slack;
  while (at_ + 1 < stored_.size() && static_cast<double>(stored_[at_ + 1].pts) <= time) ++at_;
  double share = share_between(*reader_, stored_, at_, time);
  if (share * static_cast<double>(stored_[at_].duration) <= 2 * slack) share = 0;
  return {stored_[at_].frame, share, tick, 1};
}

}  // namespace knotreel::pipeline
