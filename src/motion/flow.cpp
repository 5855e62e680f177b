#include <array>
#include <cmath>

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

/// Whether a pixel whose centre is (x, y) comes back from where `way` leads it.
/// @param back where it is led from there, if that is in the picture.
bool comes_back(const Flow& backward, float x, float y, const float* way, Tolerance tolerance,
                std::array<float, 2>& back) {
  const float dx = way[0];
  const float dy = way[1];
  const float there_x = x + dx;
  const float there_y = y + dy;
  if (!(there_x >= 0 && there_y >= 0 && there_x <= float(backward.width) &&
        there_y <= float(backward.height))) {
    return false;
  }
  const Cell cell = cell_at(there_x, there_y, backward.width, backward.height);
  back = {cell.sample(backward.xy.data(), 2), cell.sample(backward.xy.data() + 1, 2)};
  const float off_x = dx + back[0];
  const float off_y = dy + back[1];
  const float allowed = tolerance.least + tolerance.share * std::sqrt(dx * dx + dy * dy);
  return off_x * off_x + off_y * off_y <= allowed * allowed;
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
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      std::array<float, 2> back{};
      result[i] = comes_back(backward, float(i - y * width) + 0.5F, float(y) + 0.5F, &forward.xy[2 * i],
                             tolerance, back);
      if (result[i]) found(i, back);
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
