// SPDX-License-Identifier: GPL-3.0-or-later
#include "webp_end.h"

#include <algorithm>
#include <cstring>

namespace knotreel::video {
namespace {

constexpr std::size_t kFileHeader = 12, kChunkHeader = 8;
constexpr std::size_t kFrameHeader = 16, kDurationInFrame = 12;  // bytes of a chunk ANMF
constexpr std::int64_t kLongest = 0xFFFFFF;                      // milliseconds in three bytes

std::uint32_t number_at(const std::uint8_t* bytes, int count) {
  std::uint32_t value = 0;
  while (count-- > 0) value = value << 8 | bytes[count];
  return value;
}

bool is_called(const std::uint8_t* bytes, const char* name) {
  return std::memcmp(bytes, name, 4) == 0;
}

}  // namespace

void end_webp_at(AVPacket& packet, std::int64_t milliseconds) {
  const auto size = std::size_t(packet.size);
  if (size < kFileHeader || !is_called(packet.data, "RIFF") || !is_called(packet.data + 8, "WEBP")) return;
  std::size_t last = 0;  // place of the duration of the last frame
  std::int64_t begin = 0;
  for (std::size_t at = kFileHeader; at + kChunkHeader + kFrameHeader <= size;) {
    const std::uint8_t* chunk = packet.data + at;
    if (is_called(chunk, "ANMF")) {
      if (last > 0) begin += number_at(packet.data + last, 3);
      last = at + kChunkHeader + kDurationInFrame;
    }
    at += kChunkHeader + (std::size_t(number_at(chunk + 4, 4)) + 1) / 2 * 2;
  }
  if (last == 0 || milliseconds <= begin) return;
  if (av_packet_make_writable(&packet) < 0) throw std::bad_alloc();
  const std::int64_t duration = std::min(milliseconds - begin, kLongest);
  for (std::size_t i = 0; i < 3; ++i) packet.data[last + i] = std::uint8_t(duration >> (8 * i));
}

}  // namespace knotreel::video
