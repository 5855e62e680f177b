#include "cli/document_part.h"

#include <fmt/core.h>

#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/pipeline/sequence.h"

namespace knotreel::cli {

FrameRange frames_of(const document::Reader& reader, const video::Part& part) {
  constexpr double kSameTime = 1e-6;  // seconds
  FrameRange range{part.first, {}};
  if (part.count > 0) range.last = part.first + part.count - 1;
  const bool by_time = part.start > 0 || std::isfinite(part.end);
  if (!by_time) return range;
  const double tick = pipeline::stream_info(reader.info()).time_base.value();
  const auto time = [&](std::size_t i) { return double(reader.record(i).pts - reader.record(0).pts) * tick; };
  const auto first_from = [&](double seconds) {
    std::size_t i = 0;
    while (i < reader.frame_count() && time(i) < seconds - kSameTime) ++i;
    return i;
  };
  range.first = first_from(part.start);
  const std::size_t end = first_from(part.end);
  if (range.first == end) {
    const std::string to = std::isfinite(part.end) ? fmt::format("to {} s", part.end) : "on";
    throw Error(ErrorKind::kInvalidArgument,
                fmt::format("there is no frame from {} s {}: the last one is at {} s", part.start, to,
                            time(reader.frame_count() - 1)));
  }
  range.last = end - 1;
  return range;
}

std::size_t frames_in(const FrameRange& range, const document::Reader& reader) {
  const std::size_t count = reader.frame_count();
  const std::size_t last = range.last.value_or(count - 1);
  if (range.first > last || last >= count) {
    throw Error(ErrorKind::kInvalidArgument,
                fmt::format("there are no frames {}-{}: the document has {}, counted from 0", range.first,
                            last, count));
  }
  return last - range.first + 1;
}

}  // namespace knotreel::cli
