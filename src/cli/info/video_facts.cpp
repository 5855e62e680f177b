// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <cmath>
#include <filesystem>

#include "cli/info/facts.h"
#include "knotreel/video/reader.h"

namespace knotreel::cli {
namespace {

Facts streams_facts(const std::vector<video::StreamEntry>& streams) {
  Facts all = Facts::array();
  for (const video::StreamEntry& s : streams) {
    all.push_back({{"stream", s.index}, {"kind", s.kind}, {"codec", s.codec}, {"language", s.language}});
  }
  return all;
}

/// Of a file; a folder or a pattern has none of its own.
std::uint64_t bytes_of(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return 0;
  return std::uint64_t(std::filesystem::file_size(path, ignored));
}

std::string stream_text(const Facts& stream) {
  const std::string language = stream["language"].get<std::string>();
  return fmt::format("stream {:<8} {}, {}{}\n", stream["stream"].get<int>(),
                     stream["kind"].get<std::string>(), stream["codec"].get<std::string>(),
                     language.empty() ? "" : ", " + language);
}

Facts colour_facts(const video::ColourTags& tags) {
  const video::ColourNames names = video::names_of(tags);
  return {{"range", names.range},
          {"matrix", names.matrix},
          {"primaries", names.primaries},
          {"transfer", names.transfer},
          {"chroma_location", names.chroma_location}};
}

/// A line of what is told; empty if that is nothing.
std::string colour_text(const Facts& colour) {
  std::string text;
  const auto add = [&](const char* what, const char* key) {
    const std::string name = colour[key].get<std::string>();
    if (!name.empty()) text += (text.empty() ? "" : ", ") + std::string(what) + " " + name;
  };
  add("range", "range");
  add("matrix", "matrix");
  add("primaries", "primaries");
  add("transfer", "transfer");
  add("chroma", "chroma_location");
  return text.empty() ? text : "colour          " + text + "\n";
}

Facts fields_facts(video::Fields fields) {
  if (fields == video::Fields::kNone) return nullptr;
  return fields == video::Fields::kTopFirst ? "top" : "bottom";
}

std::string length_text(const Facts& facts) {
  if (facts["frames"] == 0) return "not told";
  return fmt::format("about {} frames, {:.3f} s", facts["frames"].get<std::uint64_t>(),
                     facts["seconds"].get<double>());
}

}  // namespace

Facts rational_facts(video::Rational value) {
  return value.known() ? Facts({value.num, value.den}) : Facts(nullptr);
}

std::string rate_text(const Facts& rational) {
  if (rational.is_null()) return "unknown";
  const auto num = rational[0].get<std::int64_t>();
  const auto den = rational[1].get<std::int64_t>();
  if (den == 1) return std::to_string(num);
  return fmt::format("{:.3f} ({}/{})", double(num) / double(den), num, den);
}

std::string turn_text(const Facts& facts) {
  const double degrees = facts["rotation"].get<double>();
  const std::string turned = fmt::format("{:g} degrees clockwise", degrees);
  std::string how = degrees == 0 ? "" : turned;
  if (facts["mirrored"].get<bool>()) {
    how = std::abs(degrees) == 180 ? "mirrored top to bottom" : "mirrored left to right";
    if (degrees != 0 && std::abs(degrees) != 180) how += ", then " + turned;
  }
  return how.empty() ? how : "rotation        shown " + how + "\n";
}

Facts video_facts(const std::string& path) {
  video::ReadOptions options;
  options.copy_streams = false;
  const video::VideoReader reader = video::VideoReader::open(path, options);
  const video::StreamInfo& info = reader.info();
  return {{"kind", "video"},
          {"container", info.container},
          {"codec", info.codec},
          {"width", info.width},
          {"height", info.height},
          {"channels", info.channels},
          {"depth", info.depth},
          {"pixel_format", info.pixel_format},
          {"colour", colour_facts(info.colour)},
          {"first_field", fields_facts(info.fields)},
          {"sample_aspect", rational_facts(info.sample_aspect)},
          {"rotation", video::rotation_degrees(info)},
          {"mirrored", video::is_mirrored(info)},
          {"time_base", {info.time_base.num, info.time_base.den}},
          {"frame_rate", rational_facts(info.frame_rate)},
          {"frames", info.frames},
          {"seconds", info.seconds},
          {"file_bytes", bytes_of(path)},
          {"streams", streams_facts(reader.streams())}};
}

std::string video_text(const std::string& path, const Facts& facts) {
  std::string text = fmt::format(
      "{}: {} video\n"
      "size            {}x{}, {}, {} bits per sample\n"
      "pixel format    {}\n"
      "{}"
      "rate            {} frames per second, time base {}/{} s\n"
      "length          {}\n",
      path, facts["codec"].get<std::string>(), facts["width"].get<int>(), facts["height"].get<int>(),
      channels_name(facts["channels"].get<int>()), facts["depth"].get<int>(),
      facts["pixel_format"].get<std::string>(), colour_text(facts["colour"]), rate_text(facts["frame_rate"]),
      facts["time_base"][0].get<std::int64_t>(), facts["time_base"][1].get<std::int64_t>(),
      length_text(facts));
  if (!facts["first_field"].is_null())
    text += fmt::format("interlaced      {} field first\n", facts["first_field"].get<std::string>());
  text += turn_text(facts);
  if (!facts["sample_aspect"].is_null() && facts["sample_aspect"][0] != facts["sample_aspect"][1]) {
    text += fmt::format("sample aspect   {}:{}\n", facts["sample_aspect"][0].get<std::int64_t>(),
                        facts["sample_aspect"][1].get<std::int64_t>());
  }
  text += fmt::format("container       {}\n", facts["container"].get<std::string>());
  for (const Facts& stream : facts["streams"]) text += stream_text(stream);
  if (facts["file_bytes"] != 0) {
    text += fmt::format("file            {} bytes\n", facts["file_bytes"].get<std::uint64_t>());
  }
  return text;
}

}  // namespace knotreel::cli
