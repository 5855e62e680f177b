#pragma once

#include <algorithm>
#include <cstddef>

namespace knotreel::motion {

/// The four pixels around a point and how far it is between them; beyond the outermost centres, the nearest
/// place within.
struct Cell {
  std::size_t top_left;  ///< indices of pixels, row-major
  std::size_t top_right;
  std::size_t bottom_left;
  std::size_t bottom_right;
  float x;  ///< 0 at the left pixels, 1 at the right ones
  float y;

  /// @param values of the channel asked for in the first pixel; `stride` values per pixel.
  template <typename T>
  float sample(const T* values, std::size_t stride) const {
    const auto top = float(values[top_left * stride]);
    const auto bottom = float(values[bottom_left * stride]);
    const float upper = top + x * (float(values[top_right * stride]) - top);
    const float lower = bottom + x * (float(values[bottom_right * stride]) - bottom);
    return upper + y * (lower - upper);
  }
};

/// @param x, y finite point; pixel centres are at +0.5.
inline Cell cell_at(float x, float y, int width, int height) {
  const float u = std::clamp(x - 0.5F, 0.0F, float(width - 1));
  const float v = std::clamp(y - 0.5F, 0.0F, float(height - 1));
  const int left = int(u);
  const int top = int(v);
  const std::size_t right_step = left + 1 < width ? 1 : 0;
  const std::size_t down_step = top + 1 < height ? std::size_t(width) : 0;
  const std::size_t corner = std::size_t(top) * std::size_t(width) + std::size_t(left);
  return {corner,          corner + right_step, corner + down_step, corner + down_step + right_step,
          u - float(left), v - float(top)};
}

}  // namespace knotreel::motion
