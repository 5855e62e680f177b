#include "file_end.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

namespace knotreel::video {
namespace {

std::string read_part(std::ifstream& file, std::uint64_t at, std::size_t count) {
  std::string bytes(count, '\0');
  file.clear();
  file.seekg(std::streamoff(at));
  file.read(bytes.data(), std::streamsize(count));
  bytes.resize(std::size_t(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

/// The size of an EBML element (RFC 8794, section 4): a number of 1 to 8 bytes whose length is told by the
/// zeros at its start.
struct ElementSize {
  std::uint64_t value = 0;
  std::size_t bytes = 0;  ///< 0 if there is no such number
  bool known = false;     ///< not if all bits are set
};

ElementSize element_size(std::string_view bytes) {
  if (bytes.empty()) return {};
  const auto first = std::uint8_t(bytes[0]);
  const auto count = std::size_t(std::countl_zero(first)) + 1;
  if (count > 8 || bytes.size() < count) return {};
  const std::uint64_t all = (std::uint64_t(1) << (7 * count)) - 1;
  std::uint64_t value = first;
  for (std::size_t i = 1; i < count; ++i) value = value << 8 | std::uint8_t(bytes[i]);
  value &= all;
  return {value, count, value != all};
}

/// A Matroska file is an EBML header and a segment; whoever could not go back to the start leaves its size
/// open.
bool matroska_lacks_its_end(std::ifstream& file, std::uint64_t size) {
  constexpr std::string_view kHeader = "\x1A\x45\xDF\xA3", kSegment = "\x18\x53\x80\x67";
  const std::string start = read_part(file, 0, 12);
  if (!start.starts_with(kHeader)) return false;
  const ElementSize header = element_size(std::string_view(start).substr(4));
  if (!header.known || header.value > size) return false;
  const std::uint64_t at = 4 + header.bytes + header.value;
  const std::string next = read_part(file, at, 12);
  if (!next.starts_with(kSegment)) return false;
  const ElementSize segment = element_size(std::string_view(next).substr(4));
  return segment.known && segment.value > size - std::min(size, at + 4 + segment.bytes);
}

/// The last page (RFC 3533, section 6) must be whole, and the last of its stream.
bool ogg_lacks_its_end(std::ifstream& file, std::uint64_t size) {
  constexpr std::size_t kHeader = 27, kMaxPage = kHeader + 255 + 255 * 255;
  const std::size_t count = std::size_t(std::min<std::uint64_t>(size, kMaxPage));
  const std::string end = read_part(file, size - count, count);
  const std::size_t at = end.rfind("OggS");
  if (at == std::string::npos || end.size() - at < kHeader) return true;
  const std::string_view page = std::string_view(end).substr(at);
  const std::size_t segments = std::uint8_t(page[26]);
  if (page.size() < kHeader + segments) return true;
  std::size_t length = kHeader + segments;
  for (std::size_t i = 0; i < segments; ++i) length += std::uint8_t(page[kHeader + i]);
  const bool last_of_stream = (page[5] & 4) != 0;
  return page.size() < length || !last_of_stream;
}

/// Zeros behind the marker only fill the file up.
bool lacks_marker(std::ifstream& file, std::uint64_t size, std::string_view marker) {
  const std::size_t count = std::size_t(std::min<std::uint64_t>(size, 65536));
  std::string end = read_part(file, size - count, count);
  end.resize(end.find_last_not_of('\0') + 1);
  return !end.ends_with(marker);
}

/// The last two packets must be whole: each begins with 0x47, and has 188 bytes, with a time before it 192,
/// with a checksum 204. Where the first packet begins does not matter.
bool transport_stream_lacks_its_end(std::ifstream& file, std::uint64_t size) {
  constexpr std::array<std::pair<std::size_t, std::size_t>, 3> kPackets{{{188, 0}, {192, 4}, {204, 0}}};
  const std::size_t count = std::size_t(std::min<std::uint64_t>(size, 2 * 204));
  const std::string end = read_part(file, size - count, count);
  return std::none_of(kPackets.begin(), kPackets.end(), [&](const auto& packet) {
    const auto [bytes, sync] = packet;
    if (end.size() < 2 * bytes) return true;
    return end[end.size() - bytes + sync] == 'G' && end[end.size() - 2 * bytes + sync] == 'G';
  });
}

}  // namespace

bool lacks_its_end(const std::string& path, const std::string& format) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return false;
  if (format == "matroska,webm") return matroska_lacks_its_end(file, size);
  if (format == "ogg") return ogg_lacks_its_end(file, size);
  if (format == "gif") return lacks_marker(file, size, "\x3B");
  if (format == "apng") return lacks_marker(file, size, "IEND\xAE\x42\x60\x82");
  if (format == "mpegts") return transport_stream_lacks_its_end(file, size);
  if (format == "mjpeg") return lacks_marker(file, size, "\xFF\xD9");
  return false;
}

}  // namespace knotreel::video
