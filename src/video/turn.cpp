// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/video/turn.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace knotreel::video {
namespace {

constexpr std::int32_t kOne = 1 << 16;

}  // namespace

Turn turn_of(const StreamInfo& info) {
  std::array<std::int32_t, 9> matrix{};
  if (info.display_matrix.size() != sizeof matrix) return {};
  std::memcpy(matrix.data(), info.display_matrix.data(), sizeof matrix);
  const Turn turn{matrix[0] / kOne, matrix[1] / kOne, matrix[3] / kOne, matrix[4] / kOne};
  const bool exact =
      matrix[0] % kOne == 0 && matrix[1] % kOne == 0 && matrix[3] % kOne == 0 && matrix[4] % kOne == 0;
  const auto is_step = [](int x, int y) { return x * x + y * y == 1; };
  const bool square = is_step(turn.right_x, turn.right_y) && is_step(turn.down_x, turn.down_y) &&
                      turn.right_x * turn.down_x + turn.right_y * turn.down_y == 0;
  return exact && square ? turn : Turn{};
}

image::Image turned(const image::Image& image, const Turn& turn) {
  if (turn.is_none()) return image;
  const int width = turn.swaps_sides() ? image.height : image.width;
  const int height = turn.swaps_sides() ? image.width : image.height;
  image::Image result = image::make_image(width, height, image.channels);
  // Where the first pixel goes: steps that lead back begin at the far side.
  const Vec2 first = turn.origin(width - 1, height - 1);
  const int left = static_cast<int>(first.x), top = static_cast<int>(first.y);
  const auto channels = static_cast<std::size_t>(image.channels);
  for (int y = 0; y < image.height; ++y) {
    const float* from = image.row(y).data();
    for (int x = 0; x < image.width; ++x, from += channels) {
      const int to_x = left + x * turn.right_x + y * turn.down_x;
      const int to_y = top + x * turn.right_y + y * turn.down_y;
      std::copy_n(from, channels, result.row(to_y).data() + static_cast<std::size_t>(to_x) * channels);
    }
  }
  return result;
}

StreamInfo turned(StreamInfo info, const Turn& turn) {
  if (turn.is_none()) return info;
  info.display_matrix.clear();
  if (!turn.swaps_sides()) return info;
  std::swap(info.width, info.height);
  if (info.sample_aspect.known()) std::swap(info.sample_aspect.num, info.sample_aspect.den);
  return info;
}

}  // namespace knotreel::video
