// SPDX-License-Identifier: GPL-3.0-or-later
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

using std::string_view_literals::operator""sv;

/// A file that is made of more elements is not looked at to its end: what is made up may have any number.
constexpr int kMostElements = 1'000'000;

/// Bytes in which the segment of a Matroska file begins.
constexpr std::size_t kMatroskaStart = 256;

FileEnd missing_if(bool lacks_its_end) {
  return lacks_its_end ? FileEnd::kMissing : FileEnd::kThere;
}

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

/// Whether elements follow each other from one place to another. A file of the right size may be filled up
/// with zeros, which are none.
bool are_elements(std::ifstream& file, std::uint64_t at, std::uint64_t end) {
  for (int count = 0; at < end; ++count) {
    if (count == kMostElements) return false;
    const std::string start = read_part(file, at, 12);
    const std::size_t id = start.empty() ? 0 : std::size_t(std::countl_zero(std::uint8_t(start[0]))) + 1;
    if (id < 1 || id > 4 || start.size() < id) return false;
    const ElementSize element = element_size(std::string_view(start).substr(id));
    if (!element.known || element.value > end - at) return false;
    at += id + element.bytes + element.value;
  }
  return at == end;
}

struct Segment {
  std::uint64_t begin = 0, size = 0;
  bool known = false;
};

/// A Matroska file is an EBML header and a segment; whoever could not go back to the start leaves its size
/// open.
Segment segment_of(std::string_view start) {
  constexpr std::string_view kHeader = "\x1A\x45\xDF\xA3", kSegment = "\x18\x53\x80\x67";
  if (!start.starts_with(kHeader)) return {};
  const ElementSize header = element_size(start.substr(kHeader.size()));
  if (!header.known || header.value > start.size()) return {};
  const std::size_t at = kHeader.size() + header.bytes + std::size_t(header.value);
  const std::string_view rest = start.substr(std::min(at, start.size()));
  if (!rest.starts_with(kSegment)) return {};
  const ElementSize size = element_size(rest.substr(kSegment.size()));
  return {at + kSegment.size() + size.bytes, size.value, size.known};
}

FileEnd end_of_matroska(std::ifstream& file, std::uint64_t size) {
  const Segment segment = segment_of(read_part(file, 0, kMatroskaStart));
  if (!segment.known) return FileEnd::kUnknown;
  if (segment.size > size - std::min(size, segment.begin)) return FileEnd::kMissing;
  return are_elements(file, segment.begin, segment.begin + segment.size) ? FileEnd::kThere
                                                                         : FileEnd::kUnknown;
}

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i > 0; --i) value = value << 8 | std::uint8_t(bytes[i - 1]);
  return value;
}

/// Whether chunks follow each other from one place to another, each at an even one.
bool are_chunks(std::ifstream& file, std::uint64_t at, std::uint64_t end) {
  for (int count = 0; at + 8 <= end; ++count) {
    const std::string start = read_part(file, at, 8);
    if (count == kMostElements || start.size() < 8 || start[0] == '\0') return false;
    at += 8 + (std::uint64_t(little_endian(std::string_view(start).substr(4))) + 1) / 2 * 2;
  }
  return at <= end + 1;
}

/// An AVI file is one RIFF chunk, or several of about a gigabyte. Some count the eight bytes before a chunk
/// as of it. Whoever could not go back to the start tells a size of zero, or the largest.
FileEnd end_of_avi(std::ifstream& file, std::uint64_t size) {
  constexpr std::uint64_t kHeader = 12;
  std::uint64_t at = 0;
  for (int count = 0; at + kHeader <= size; ++count) {
    const std::string start = read_part(file, at, kHeader);
    if (!start.starts_with("RIFF")) break;
    const std::uint64_t bytes = little_endian(std::string_view(start).substr(4));
    if (bytes == 0 || bytes == 0xFFFFFFFF || count == kMostElements) return FileEnd::kUnknown;
    if (at + bytes > size) return FileEnd::kMissing;
    const std::uint64_t end = std::min(size, at + 8 + bytes);
    if (!are_chunks(file, at + kHeader, end)) return FileEnd::kUnknown;
    at = end + end % 2;
  }
  return at > 0 ? FileEnd::kThere : FileEnd::kUnknown;
}

/// libav's NUT files end with an index, whose last twelve bytes tell how far back it begins, and a checksum.
bool nut_lacks_its_end(std::ifstream& file, std::uint64_t size) {
  constexpr std::string_view kIndex = "\x4E\x58\xDD\x67\x2F\x23\xE6\x4E";
  const std::string end = read_part(file, size - std::min<std::uint64_t>(size, 12), 12);
  if (end.size() < 12) return true;
  std::uint64_t back = 0;
  for (std::size_t i = 0; i < 8; ++i) back = back << 8 | std::uint8_t(end[i]);
  return back > size || read_part(file, size - back, kIndex.size()) != kIndex;
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

/// The header of an ASF file (as WMV is one) tells the size of it all, or zero.
FileEnd end_of_asf(std::ifstream& file, std::uint64_t size) {
  constexpr std::string_view kFileProperties =
      "\xA1\xDC\xAB\x8C\x47\xA9\xCF\x11\x8E\xE4\x00\xC0\x0C\x20\x53\x65"sv;
  constexpr std::size_t kSizeInObject = 40, kMostHeader = 65536;
  const std::string start = read_part(file, 0, kMostHeader);
  const std::size_t at = start.find(kFileProperties);
  if (at == std::string::npos || start.size() - at < kSizeInObject + 8) return FileEnd::kUnknown;
  const std::string_view bytes = std::string_view(start).substr(at + kSizeInObject);
  const std::uint64_t told = std::uint64_t(little_endian(bytes.substr(4))) << 32 | little_endian(bytes);
  if (told == 0) return FileEnd::kUnknown;
  return missing_if(told > size);
}

}  // namespace

FileEnd end_of_file(const std::string& path, const std::string& format) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return FileEnd::kUnknown;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return FileEnd::kUnknown;
  if (format == "matroska,webm") return end_of_matroska(file, size);
  if (format == "avi") return end_of_avi(file, size);
  if (format == "asf") return end_of_asf(file, size);
  if (format == "nut") return missing_if(nut_lacks_its_end(file, size));
  if (format == "ogg") return missing_if(ogg_lacks_its_end(file, size));
  if (format == "gif") return missing_if(lacks_marker(file, size, "\x3B"));
  if (format == "apng") return missing_if(lacks_marker(file, size, "IEND\xAE\x42\x60\x82"));
  if (format == "mjpeg") return missing_if(lacks_marker(file, size, "\xFF\xD9"));
  if (format == "mpegts" && transport_stream_lacks_its_end(file, size)) return FileEnd::kMissing;
  return FileEnd::kUnknown;
}

FileEnd end_of_pipe(std::string_view start, std::uint64_t size, const std::string& format) {
  const Segment segment = format == "matroska,webm" ? segment_of(start) : Segment{};
  const bool is_there = segment.known && size >= segment.begin && size - segment.begin >= segment.size;
  return is_there ? FileEnd::kThere : FileEnd::kUnknown;
}

}  // namespace knotreel::video
