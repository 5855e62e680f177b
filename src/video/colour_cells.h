// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "knotreel/image/image.h"

namespace knotreel::video {

/// 8 bits of red, green and blue.
using Colour = std::array<std::uint8_t, 3>;

/// 0xRRGGBB.
inline std::uint32_t packed(const Colour& c) {
  return std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2];
}

/// Cells of all colours: those that agree in the upper bits of each channel.
inline constexpr int kCellBits = 6;
inline constexpr std::size_t kColourCells = std::size_t{1} << (3 * kCellBits);

inline std::size_t cell_of(const Colour& c) {
  constexpr int kDown = 8 - kCellBits;
  return (std::size_t(c[0] >> kDown) << (2 * kCellBits)) | (std::size_t(c[1] >> kDown) << kCellBits) |
         std::size_t(c[2] >> kDown);
}

inline std::array<float, 3> centre_of_cell(std::size_t cell) {
  constexpr std::size_t kMost = (std::size_t{1} << kCellBits) - 1;
  constexpr float kSize = float(1 << (8 - kCellBits));
  const auto middle = [&](std::size_t shift) {
    return float((cell >> shift) & kMost) * kSize + (kSize - 1) / 2;
  };
  return {middle(2 * kCellBits), middle(kCellBits), middle(0)};
}

/// The pixels of a picture as colours; grey ones are colours, too.
class ColourPixels {
 public:
  explicit ColourPixels(const image::Image& picture)
      : picture_(picture),
        channels_(std::size_t(picture.channels)),
        green_(picture.colour_channels() == 1 ? 0 : 1) {}

  std::size_t size() const { return picture_.pixel_count(); }
  bool has_alpha() const { return picture_.has_alpha(); }
  bool is_seen(std::size_t i) const { return !has_alpha() || at(i)[channels_ - 1] >= 127.5F; }

  /// 0 to 255.
  std::array<float, 3> exact_colour(std::size_t i) const {
    const float* const pixel = at(i);
    return {inside(pixel[0]), inside(pixel[green_]), inside(pixel[2 * green_])};
  }
  /// Rounded.
  Colour colour(std::size_t i) const {
    const std::array<float, 3> exact = exact_colour(i);
    return {std::uint8_t(exact[0] + 0.5F), std::uint8_t(exact[1] + 0.5F), std::uint8_t(exact[2] + 0.5F)};
  }

 private:
  static float inside(float sample) { return std::clamp(sample, 0.0F, 255.0F); }
  const float* at(std::size_t i) const { return &picture_.samples[i * channels_]; }

  const image::Image& picture_;
  std::size_t channels_;
  std::size_t green_;
};

}  // namespace knotreel::video
