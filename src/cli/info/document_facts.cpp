// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <algorithm>

#include "cli/info/facts.h"
#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "cli/printable.h"
#include "knotreel/document/reader.h"
#include "knotreel/pipeline/sequence.h"

namespace knotreel::cli {
namespace {

Facts frame_facts(std::size_t index, const document::FrameRecord& record, const document::FrameModel& model) {
  const auto& space = *model.space;
  return {{"frame", index},
          {"pts", record.pts},
          {"keyframe", record.keyframe},
          {"bytes", record.bytes},
          {"knots", space.mesh().knots.size()},
          {"triangles", space.mesh().faces.size()},
          {"feature_segments", space.mesh().segments.size()},
          {"control_points", space.function_count()},
          {"raw_accounting_bytes", document::raw_accounting_bytes(model)}};
}

std::uint64_t sum(const Facts& frames, const char* member) {
  std::uint64_t total = 0;
  for (const Facts& frame : frames) total += frame[member].get<std::uint64_t>();
  return total;
}

/// Least, mean and largest number of a frame.
Facts range(const Facts& frames, const char* member) {
  std::uint64_t least = ~std::uint64_t{0};
  std::uint64_t most = 0;
  for (const Facts& frame : frames) {
    const auto value = frame[member].get<std::uint64_t>();
    least = std::min(least, value);
    most = std::max(most, value);
  }
  const double mean = double(sum(frames, member)) / double(frames.size());
  return {{"min", least}, {"mean", mean}, {"max", most}};
}

/// From the first frame to the end of the last one.
double duration_of(const document::Reader& reader) {
  const std::size_t last = reader.frame_count() - 1;
  const std::int64_t ticks = reader.record(last).pts + pipeline::last_duration(reader) - reader.record(0).pts;
  return double(ticks) * double(reader.info().time_base_num) / double(reader.info().time_base_den);
}

std::string range_text(const Facts& range) {
  return fmt::format("{} to {} per frame, mean {:.1f}", range["min"].get<std::uint64_t>(),
                     range["max"].get<std::uint64_t>(), range["mean"].get<double>());
}

/// A single frame has no times and no groups worth telling of.
std::string counts_text(const Facts& facts) {
  const Facts& base = facts["time_base"];
  const auto count = [&](const char* member) { return facts[member].get<std::uint64_t>(); };
  if (count("frame_count") == 1) {
    return fmt::format("frames          1, time base {}/{} s\n", base[0].get<std::int64_t>(),
                       base[1].get<std::int64_t>());
  }
  return fmt::format("frames          {} in {}, time base {}/{} s\n", count("frame_count"),
                     counted(count("groups"), "group"), base[0].get<std::int64_t>(),
                     base[1].get<std::int64_t>()) +
         fmt::format("duration        {:.3f} s, {} frames per second\n", facts["seconds"].get<double>(),
                     rate_text(facts["frame_rate"]));
}

}  // namespace

Facts document_facts(const std::string& path) {
  document::Reader reader = open_document_silently(path);
  const document::SequenceInfo& info = reader.info();
  const video::StreamInfo stream = pipeline::stream_info(info);
  Facts frames = Facts::array();
  std::uint64_t groups = 0;
  for (std::size_t i = 0; i < reader.frame_count(); ++i) {
    check_interrupted();
    const document::FrameRecord record = reader.record(i);
    frames.push_back(frame_facts(i, record, reader.read(i)));
    groups += record.keyframe ? 1 : 0;
  }
  return {{"kind", "document"},
          {"width", info.width},
          {"height", info.height},
          {"channels", info.channels},
          {"degree", info.degree},
          {"rotation", video::rotation_degrees(stream)},
          {"mirrored", video::is_mirrored(stream)},
          {"time_base", {info.time_base_num, info.time_base_den}},
          {"frame_rate", rational_facts(stream.frame_rate)},
          {"frame_count", frames.size()},
          {"groups", groups},
          {"seconds", duration_of(reader)},
          {"complete", reader.complete()},
          {"file_bytes", reader.file_bytes()},
          {"raw_accounting_bytes", sum(frames, "raw_accounting_bytes")},
          {"knots", sum(frames, "knots")},
          {"control_points", sum(frames, "control_points")},
          {"knots_per_frame", range(frames, "knots")},
          {"control_points_per_frame", range(frames, "control_points")},
          {"bytes_per_frame", range(frames, "bytes")},
          {"metadata", info.metadata},
          {"frames", std::move(frames)}};
}

std::string document_text(const std::string& path, const Facts& facts) {
  const bool still = facts["frame_count"] == 1;
  const auto counts = [&](const char* all, const char* per_frame) {
    const std::string sum = std::to_string(facts[all].get<std::uint64_t>());
    return still ? sum : range_text(facts[per_frame]);
  };
  std::string text = fmt::format(
      "{}: knotreel vector document\n"
      "size            {}x{}, {}\n"
      "{}{}"
      "state           {}\n"
      "degree          {}\n"
      "knots           {}\n"
      "control points  {}\n"
      "raw accounting  {} bytes (20 per control point, 8 per knot, 6 per triangle)\n"
      "file            {} bytes{}\n",
      path, facts["width"].get<int>(), facts["height"].get<int>(),
      channels_name(facts["channels"].get<int>()), turn_text(facts), counts_text(facts),
      facts["complete"].get<bool>() ? "complete" : "truncated: read up to the last whole frame",
      facts["degree"].get<int>(), counts("knots", "knots_per_frame"),
      counts("control_points", "control_points_per_frame"),
      facts["raw_accounting_bytes"].get<std::uint64_t>(), facts["file_bytes"].get<std::uint64_t>(),
      still ? "" : ", " + range_text(facts["bytes_per_frame"]));
  for (const auto& [key, value] : facts["metadata"].items()) {
    text += fmt::format("{:<15} {}\n", key, value.get<std::string>());
  }
  return text;
}

}  // namespace knotreel::cli
