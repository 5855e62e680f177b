// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::motion {

/// The four pixels around a point and how far it is between them; beyond the outermost centres, the nearest
/// place within.
struct Cell {
  int top_left;  ///< indices of pixels, row-major
  int top_right;
  int bottom_left;
  int bottom_right;
  float x;  ///< 0 at the left pixels, 1 at the right ones
  float y;

  /// @param values of the channel asked for in the first pixel; `stride` values per pixel.
  template <typename T>
  [[gnu::always_inline]] float sample(const T* values, int stride) const {
    const auto top = float(values[top_left * stride]);
    const auto bottom = float(values[bottom_left * stride]);
    const float upper = top + x * (float(values[top_right * stride]) - top);
    const float lower = bottom + x * (float(values[bottom_right * stride]) - bottom);
    return upper + y * (lower - upper);
  }
};

/// Without branches, so that loops over a row can use vectors; indices are small for that too: pictures have
/// less than 2^31 samples.
/// @param x, y finite point; pixel centres are at +0.5.
[[gnu::always_inline]] inline Cell cell_at(float x, float y, int width, int height) {
  const auto inside = [](float v, float most) {
    v = v > 0 ? v : 0;
    return v < most ? v : most;
  };
  const float u = inside(x - 0.5F, float(width - 1));
  const float v = inside(y - 0.5F, float(height - 1));
  const int left = int(u);
  const int top = int(v);
  const int right_step = int(left + 1 < width);
  const int down_step = int(top + 1 < height) * width;
  const int corner = top * width + left;
  return {corner,          corner + right_step, corner + down_step, corner + down_step + right_step,
          u - float(left), v - float(top)};
}

}  // namespace knotreel::motion
