// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/document_part.h"

#include <fmt/core.h>

#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/pipeline/sequence.h"

namespace knotreel::cli {

FrameRange frames_of(const document::Reader& reader, const video::Part& part) {
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < reader.frame_count(); ++i) times.push_back(reader.record(i).pts);
  return frames_of(times, pipeline::stream_info(reader.info()).time_base.value(), part);
}

FrameRange frames_of(const std::vector<std::int64_t>& times, double tick, const video::Part& part) {
  constexpr double kSameTime = 1e-6;  // seconds
  FrameRange range{part.first, {}};
  if (part.count > 0) range.last = part.first + part.count - 1;
  const bool by_time = part.start > 0 || std::isfinite(part.end);
  if (!by_time) return range;
  const auto time = [&](std::size_t i) { return double(times[i] - times[0]) * tick; };
  const auto first_from = [&](double seconds) {
    std::size_t i = 0;
    while (i < times.size() && time(i) < seconds - kSameTime) ++i;
    return i;
  };
  range.first = first_from(part.start);
  const std::size_t end = first_from(part.end);
  if (range.first == end) {
    const std::string to = std::isfinite(part.end) ? fmt::format("to {} s", part.end) : "on";
    throw Error(ErrorKind::kInvalidArgument,
                fmt::format("there is no frame from {} s {}: the last one is at {} s", part.start, to,
                            time(times.size() - 1)));
  }
  range.last = end - 1;
  return range;
}

std::size_t frames_in(const FrameRange& range, const document::Reader& reader) {
  return frames_in(range, reader.frame_count());
}

std::size_t frames_in(const FrameRange& range, std::size_t count) {
  if (!range.last && range.first >= count) {
    throw Error(ErrorKind::kInvalidArgument,
                fmt::format("there is no frame {}: the document has {}, counted from 0", range.first, count));
  }
  const std::size_t last = range.last.value_or(count - 1);
  if (range.first > last || last >= count) {
    throw Error(ErrorKind::kInvalidArgument,
                fmt::format("there are no frames {}-{}: the document has {}, counted from 0", range.first,
                            last, count));
  }
  return last - range.first + 1;
}

}  // namespace knotreel::cli
