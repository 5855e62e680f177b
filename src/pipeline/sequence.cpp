// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/sequence.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "knotreel/base/ticks.h"

namespace knotreel::pipeline {
namespace {

using Metadata = std::map<std::string, std::string>;

constexpr const char* kDigits = "0123456789abcdef";
constexpr std::size_t kMatrixBytes = 36;

std::string text_of(video::Rational r) {
  return std::to_string(r.num) + "/" + std::to_string(r.den);
}

std::string hex_of(const std::vector<std::byte>& bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    text += kDigits[std::to_integer<unsigned>(b) >> 4];
    text += kDigits[std::to_integer<unsigned>(b) & 15];
  }
  return text;
}

std::string text_of(const video::ColourTags& tags) {
  std::string text = std::to_string(tags.range);
  for (const int tag : {tags.matrix, tags.primaries, tags.transfer, tags.chroma_location}) {
    text += " " + std::to_string(tag);
  }
  return text;
}

std::string value(const Metadata& metadata, const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? std::string() : found->second;
}

/// Whole numbers between separators; empty if there is anything else.
std::vector<std::int64_t> numbers(std::string_view text, char separator) {
  std::vector<std::int64_t> all;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(separator));
    std::int64_t number = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (status != std::errc() || end != word.data() + word.size()) return {};
    all.push_back(number);
    text.remove_prefix(std::min(text.size(), word.size() + 1));
  }
  return all;
}

video::Rational rational(const std::string& text) {
  constexpr std::int64_t kMost = 0x7fffffff;
  const auto n = numbers(text, '/');
  const bool sound = n.size() == 2 && n[0] > 0 && n[1] > 0 && n[0] <= kMost && n[1] <= kMost;
  return sound ? video::Rational{n[0], n[1]} : video::Rational{};
}

video::ColourTags colour_tags(const std::string& text) {
  const auto n = numbers(text, ' ');
  if (n.size() != 5) return {};
  for (const std::int64_t tag : n) {
    if (tag < 0 || tag > 255) return {};
  }
  return {int(n[0]), int(n[1]), int(n[2]), int(n[3]), int(n[4])};
}

std::vector<std::byte> bytes_of(const std::string& hex) {
  std::vector<std::byte> bytes;
  if (hex.size() != 2 * kMatrixBytes) return bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    unsigned byte = 0;
    if (std::from_chars(&hex[i], &hex[i] + 2, byte, 16).ptr != &hex[i] + 2) return {};
    bytes.push_back(std::byte(byte));
  }
  return bytes;
}

/// As for other nonsense, a number beyond what times of documents may be counts as not told.
std::int64_t number(const std::string& text, std::int64_t otherwise) {
  const auto n = numbers(text, ' ');
  return n.size() == 1 && is_time(n[0]) ? n[0] : otherwise;
}

/// Bits per component, likewise.
int bits_of(const std::string& text) {
  constexpr int kUsual = 8, kMost = 32;
  const std::int64_t told = number(text, kUsual);
  return told >= 1 && told <= kMost ? int(told) : kUsual;
}

/// Of the last frame of a document that does not tell it. @param step  from the frame before; 0: there is
/// none.
std::int64_t concluded_duration(const document::SequenceInfo& info, std::int64_t pts, std::int64_t step) {
  const video::StreamInfo stream = stream_info(info);
  const std::int64_t nominal = nominal_duration(stream);
  const std::int64_t usual = nominal > 0 ? nominal : step;
  const std::int64_t told = stream.end - pts;
  return told > usual / 4 && told < usual * 4 ? told : usual;
}

}  // namespace

document::SequenceInfo sequence_info(const video::StreamInfo& stream, const std::string& source, int degree) {
  document::SequenceInfo info;
  info.width = stream.width;
  info.height = stream.height;
  info.channels = stream.channels;
  info.degree = degree;
  info.time_base_num = stream.time_base.num;
  info.time_base_den = stream.time_base.den;
  info.metadata["source"] = source;
  info.metadata["depth"] = std::to_string(stream.depth);
  info.metadata["colour_tags"] = text_of(stream.colour);
  if (stream.start != 0) info.metadata["start"] = std::to_string(stream.start);
  if (!stream.pixel_format.empty()) info.metadata["pixel_format"] = stream.pixel_format;
  if (stream.frame_rate.known()) info.metadata["frame_rate"] = text_of(stream.frame_rate);
  if (stream.sample_aspect.known()) info.metadata["sample_aspect"] = text_of(stream.sample_aspect);
  if (!stream.display_matrix.empty()) info.metadata["display_matrix"] = hex_of(stream.display_matrix);
  if (stream.end > 0) info.metadata["end"] = std::to_string(stream.end);
  return info;
}

video::StreamInfo stream_info(const document::SequenceInfo& info) {
  video::StreamInfo stream;
  stream.width = info.width;
  stream.height = info.height;
  stream.channels = info.channels;
  stream.time_base = {info.time_base_num, info.time_base_den};
  const Metadata& metadata = info.metadata;
  stream.depth = bits_of(value(metadata, "depth"));
  stream.pixel_format = value(metadata, "pixel_format");
  stream.frame_rate = rational(value(metadata, "frame_rate"));
  stream.sample_aspect = rational(value(metadata, "sample_aspect"));
  stream.colour = colour_tags(value(metadata, "colour_tags"));
  stream.display_matrix = bytes_of(value(metadata, "display_matrix"));
  stream.start = number(value(metadata, "start"), 0);
  stream.end = number(value(metadata, "end"), 0);
  return stream;
}

std::int64_t nominal_duration(const video::StreamInfo& stream) {
  if (!stream.frame_rate.known()) return 0;
  const double ticks = 1 / (stream.frame_rate.value() * stream.time_base.value());
  return std::llround(std::min(ticks, static_cast<double>(kMaxTicks)));
}

std::int64_t last_duration(const document::Reader& reader) {
  if (reader.last_duration() > 0) return reader.last_duration();
  const std::size_t last = reader.frame_count() - 1;
  const std::int64_t pts = reader.record(last).pts;
  return concluded_duration(reader.info(), pts, last > 0 ? pts - reader.record(last - 1).pts : 0);
}

std::int64_t duration_to_tell(const document::SequenceInfo& info, const LastFrame& last) {
  return last.duration == concluded_duration(info, last.pts, last.step) ? 0 : last.duration;
}

}  // namespace knotreel::pipeline
