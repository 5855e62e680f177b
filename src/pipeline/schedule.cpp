#include "pipeline/schedule.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "knotreel/base/error.h"
#include "knotreel/pipeline/sequence.h"

namespace knotreel::pipeline {
namespace {

std::size_t checked_last(const RenderJob& job) {
  const std::size_t count = job.reader->frame_count();
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

/// Frames at the ticks of another rate.
std::vector<Showing> resampled(const document::Reader& reader, const std::vector<Showing>& stored,
                               double ticks_per_frame) {
  const std::int64_t begin = stored.front().pts;
  const double length = static_cast<double>(stored.back().pts + stored.back().duration - begin);
  const auto count = std::max(1LL, std::llround(length / ticks_per_frame));
  // Times that are meant to be those of a frame are so but for rounding.
  const double slack = 1e-6 * ticks_per_frame;
  std::vector<Showing> frames;
  std::size_t at = 0;
  for (std::int64_t k = 0; k < count; ++k) {
    const double time = static_cast<double>(begin) + static_cast<double>(k) * ticks_per_frame + slack;
    while (at + 1 < stored.size() && static_cast<double>(stored[at + 1].pts) <= time) ++at;
    double share = share_between(reader, stored, at, time);
    if (share * static_cast<double>(stored[at].duration) <= 2 * slack) share = 0;
    frames.push_back({stored[at].frame, share, k, 1});
  }
  return frames;
}

}  // namespace

Schedule make_schedule(const RenderJob& job) {
  const std::size_t last = checked_last(job);
  Schedule schedule{stream_info(job.reader->info()), as_stored(job, last)};
  if (job.first > 0) {
    schedule.stream.start = 0;
    schedule.origin = job.reader->record(job.first).pts;
  }
  if (!job.rate.known()) return schedule;
  schedule.origin = job.reader->record(job.first).pts;
  const double ticks = 1 / (job.rate.value() * schedule.stream.time_base.value());
  schedule.frames = resampled(*job.reader, schedule.frames, ticks);
  schedule.stream.frame_rate = job.rate;
  schedule.stream.time_base = {job.rate.den, job.rate.num};
  schedule.stream.start = 0;
  return schedule;
}

}  // namespace knotreel::pipeline
