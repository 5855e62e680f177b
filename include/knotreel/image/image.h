// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"

/// Pictures in memory and in files. Pixel (x, y) has its centre at (x + 0.5, y + 0.5); y points down (see
/// knotreel/base/vec2.h).
namespace knotreel::image {

/// Most pixels that a picture in memory may have; larger ones are refused before anything is allocated.
inline constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;

/// A picture as floats: row-major, channels interleaved, on the scale 0..255 whatever the depth of the file.
/// Channels: 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA; alpha is not premultiplied. Values are those of the file
/// (gamma-encoded, usually sRGB).
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> samples;

  bool has_alpha() const { return channels == 2 || channels == 4; }
  /// Channels without alpha: 1 or 3.
  int colour_channels() const { return has_alpha() ? channels - 1 : channels; }
  std::uint64_t pixel_count() const { return std::uint64_t(width) * std::uint64_t(height); }
  /// Samples of a row.
  std::size_t row_size() const { return std::size_t(width) * std::size_t(channels); }

  /// Rows and samples that are in the picture; nothing is checked.
  std::span<float> row(int y) { return std::span(samples).subspan(std::size_t(y) * row_size(), row_size()); }
  std::span<const float> row(int y) const {
    return std::span(samples).subspan(std::size_t(y) * row_size(), row_size());
  }
  float at(int x, int y, int channel) const {
    return samples[std::size_t(y) * row_size() + std::size_t(x) * std::size_t(channels) +
                   std::size_t(channel)];
  }
  float& at(int x, int y, int channel) {
    return samples[std::size_t(y) * row_size() + std::size_t(x) * std::size_t(channels) +
                   std::size_t(channel)];
  }
};

/// @throws Error{kInvalidArgument} for a picture without pixels, with channels outside 1..4, or with more or
/// fewer samples than it tells of. So does all that takes pictures.
void check_image(const Image& image);

/// A black (and, with alpha, transparent) picture.
/// @throws Error{kInvalidArgument} for sizes below 1, channels outside 1..4, or more than kMaxPixels.
Image make_image(int width, int height, int channels);

/// The same picture with other channels: grey becomes RGB by repetition, missing alpha becomes 255.
/// @throws Error{kInvalidArgument} if colour or alpha would be lost.
Image widen_channels(const Image& image, int channels);

}  // namespace knotreel::image
