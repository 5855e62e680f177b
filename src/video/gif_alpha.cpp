// SPDX-License-Identifier: GPL-3.0-or-later
#include "gif_alpha.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <span>

namespace knotreel::video {
namespace {

constexpr std::uint8_t kExtension = 0x21, kGraphicControl = 0xF9;
constexpr int kClear = 2;  ///< disposal method

/// Goes through the blocks of a file.
class GifBlocks {
 public:
  explicit GifBlocks(std::istream& file) : file_(file) {}

  /// 0 at the end.
  std::uint8_t byte() {
    const int c = file_.get();
    return c < 0 ? 0 : std::uint8_t(c);
  }
  void skip(std::streamoff count) { file_.seekg(count, std::ios::cur); }
  void skip_sub_blocks() {
    while (const std::uint8_t size = byte()) skip(size);
  }
  /// Of a screen or an image, whose flags tell of it.
  void skip_colours(std::uint8_t flags) {
    if ((flags & 0x80) != 0) skip(3 * (2 << (flags & 7)));
  }

  /// The signature, the screen and its colours.
  void skip_header() {
    skip(10);
    const std::uint8_t flags = byte();
    skip(2);
    skip_colours(flags);
  }
  void skip_image() {
    skip(8);
    skip_colours(byte());
    skip(1);
    skip_sub_blocks();
  }
  /// @return whether it says that its frame is cleared.
  bool skip_extension() {
    if (byte() != kGraphicControl) {
      skip_sub_blocks();
      return false;
    }
    skip(1);
    const bool clears = ((byte() >> 2) & 7) == kClear;
    skip(3);
    skip_sub_blocks();
    return clears;
  }

 private:
  std::istream& file_;
};

}  // namespace

bool is_opaque(const AVFrame& frame) {
  for (int y = 0; y < frame.height; ++y) {
    const std::uint8_t* const row = frame.data[0] + std::ptrdiff_t(y) * frame.linesize[0];
    for (int x = 0; x < frame.width; ++x) {
      if (row[4 * x + 3] != 0xFF) return false;
    }
  }
  return true;
}

bool stays_opaque(std::istream& gif) {
  GifBlocks blocks(gif);
  blocks.skip_header();
  for (;;) {
    switch (blocks.byte()) {
      case kExtension:
        if (blocks.skip_extension()) return false;
        break;
      case ',':
        blocks.skip_image();
        break;
      case ';':
        return true;
      default:
        return false;
    }
  }
}

void clear_before_next(AVPacket& packet) {
  if (av_packet_make_writable(&packet) < 0) throw std::bad_alloc();
  constexpr std::array<std::uint8_t, 3> kStart{kExtension, kGraphicControl, 4};
  const std::span<std::uint8_t> bytes(packet.data, std::size_t(packet.size));
  constexpr std::size_t kScreen = 13;  // bytes; its flags are the 11th
  std::size_t at = 0;
  if (bytes.size() > kScreen && bytes[0] == 'G')
    at = kScreen + ((bytes[10] & 0x80) != 0 ? std::size_t(3 * (2 << (bytes[10] & 7))) : 0);
  if (bytes.size() < at + kStart.size() + 1) return;
  std::uint8_t* const extension = bytes.data() + at;
  if (!std::equal(kStart.begin(), kStart.end(), extension)) return;
  extension[3] = std::uint8_t((extension[3] & ~(7 << 2)) | kClear << 2);
}

}  // namespace knotreel::video
