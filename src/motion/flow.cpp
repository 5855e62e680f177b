// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "knotreel/motion/flow.h"
#include "motion/bilinear.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

struct Tolerance {
  float least = float(kLeastTolerance);
  float share = float(kToleranceShare);
};

/// For the pixels of row y: whether they come back from where `way` leads them.
/// @param back where they are led from there, where that is in the picture: x and y apart.
KNOTREEL_MULTIVERSION
void come_back(const float* __restrict backward, int width, int height, int y, const float* __restrict way,
               Tolerance tolerance, std::uint8_t* __restrict found, float* __restrict back_x,
               float* __restrict back_y) {
  for (int x = 0; x < width; ++x) {
    const float dx = way[2 * x];
    const float dy = way[2 * x + 1];
    const float there_x = float(x) + 0.5F + dx;
    const float there_y = float(y) + 0.5F + dy;
    const bool inside =
        (there_x >= 0) & (there_y >= 0) & (there_x <= float(width)) & (there_y <= float(height));
    const Cell cell = cell_at(there_x, there_y, width, height);
    back_x[x] = cell.sample(backward, 2);
    back_y[x] = cell.sample(backward + 1, 2);
    const float off_x = dx + back_x[x];
    const float off_y = dy + back_y[x];
    const float allowed = tolerance.least + tolerance.share * std::sqrt(dx * dx + dy * dy);
    found[x] = inside & (off_x * off_x + off_y * off_y <= allowed * allowed);
  }
}

/// Calls found(pixel, way back) for the pixels that are found again.
/// @return which they are.
template <class Found>
std::vector<std::uint8_t> find_again(const Flow& forward, const Flow& backward, Tolerance tolerance,
                                     const Found& found) {
  check_sizes(forward, backward);
  const auto width = std::size_t(forward.width);
  std::vector<std::uint8_t> result(forward.xy.size() / 2);
  parallel_for(std::size_t(forward.height), [&](std::size_t y) {
    thread_local std::vector<float> back;
    back.resize(2 * width);
    const std::size_t row = y * width;
    come_back(backward.xy.data(), forward.width, forward.height, int(y), &forward.xy[2 * row], tolerance,
              &result[row], back.data(), back.data() + width);
    for (std::size_t x = 0; x < width; ++x) {
      if (result[row + x]) found(row + x, std::array{back[x], back[width + x]});
    }
  });
  return result;
}

}  // namespace

Vec2 Flow::at(Vec2 p) const {
  const Cell cell = cell_at(float(p.x), float(p.y), width, height);
  return {double{cell.sample(xy.data(), 2)}, double{cell.sample(xy.data() + 1, 2)}};
}

std::vector<std::uint8_t> consistent(const Flow& forward, const Flow& backward, double least, double share) {
  return find_again(forward, backward, {float(least), float(share)},
                    [](std::size_t, const std::array<float, 2>&) {});
}

std::vector<std::uint8_t> turn_round(const Flow& exact, Flow& rough) {
  return find_again(rough, exact, {}, [&rough](std::size_t pixel, const std::array<float, 2>& back) {
    rough.xy[2 * pixel] = -back[0];
    rough.xy[2 * pixel + 1] = -back[1];
  });
}

}  // namespace knotreel::motion
