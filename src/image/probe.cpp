// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe.h"

#include "bytes.h"
#include "codec.h"

namespace knotreel::image {
namespace {

[[noreturn]] void damaged() {
  throw DecodeError("its header is damaged");
}

bool has_end_marker(const Bytes& bytes, std::size_t from) {
  for (std::size_t at = bytes.size() - 1; at > from; --at) {
    if (bytes.u8(at - 1) == 0xff && bytes.u8(at) == 0xd9) return true;
  }
  return false;
}

/// ITU-T T.81 annex B: segments of marker and length up to the first scan.
ProbedSize probe_jpeg(const Bytes& bytes) {
  ProbedSize size;
  std::size_t at = 2;
  while (true) {
    if (bytes.u8(at) != 0xff) damaged();
    while (bytes.u8(at + 1) == 0xff) ++at;  // fill bytes
    const std::uint32_t marker = bytes.u8(at + 1);
    at += 2;
    if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7)) continue;  // no length
    if (marker == 0xd9) damaged();                                       // ends before a scan
    const std::uint32_t length = bytes.be16(at);
    if (length < 2) damaged();
    const bool start_of_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (start_of_frame) size = {bytes.be16(at + 5), bytes.be16(at + 3)};
    at += length;
    if (marker == 0xda) break;
  }
  if (size.width == 0) damaged();
  if (!has_end_marker(bytes, at)) throw DecodeError("the file is cut short");
  return size;
}

/// RFC 9649: the first chunk is VP8, VP8L or VP8X.
ProbedSize probe_webp(const Bytes& bytes) {
  switch (bytes.be32(12)) {
    case 0x56503820:  // "VP8 "
      return {bytes.le16(26) & 0x3fff, bytes.le16(28) & 0x3fff};
    case 0x5650384c: {  // "VP8L"
      const std::uint32_t bits = bytes.le32(21);
      return {(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
    }
    case 0x56503858:  // "VP8X"
      return {bytes.le24(24) + 1, bytes.le24(27) + 1};
    default:
      damaged();
  }
}

ProbedSize probe_bmp(const Bytes& bytes) {
  constexpr std::uint32_t kCoreHeader = 12;
  if (bytes.le32(14) == kCoreHeader) return {bytes.le16(18), bytes.le16(20)};
  const auto height = static_cast<std::int32_t>(bytes.le32(22));  // negative: top row first
  return {bytes.le32(18), static_cast<std::uint64_t>(std::llabs(height))};
}

}  // namespace

ProbedSize probe_size(std::span<const std::byte> file, ImageFormat format) {
  const Bytes bytes(file);
  switch (format) {
    case ImageFormat::kJpeg:
      return probe_jpeg(bytes);
    case ImageFormat::kWebp:
      return probe_webp(bytes);
    case ImageFormat::kBmp:
      return probe_bmp(bytes);
    default:
      damaged();
  }
}

}  // namespace knotreel::image
