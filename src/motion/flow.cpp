#include <cmath>

#include "knotreel/base/parallel.h"
#include "knotreel/motion/flow.h"
#include "motion/bilinear.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

struct Tolerance {
  float least;
  float share;
};

/// Whether a pixel whose centre is (x, y) comes back from where `dx, dy` lead it.
bool comes_back(const Flow& backward, float x, float y, float dx, float dy, Tolerance tolerance) {
  const float there_x = x + dx;
  const float there_y = y + dy;
  if (!(there_x >= 0 && there_y >= 0 && there_x <= float(backward.width) &&
        there_y <= float(backward.height))) {
    return false;
  }
  const Cell cell = cell_at(there_x, there_y, backward.width, backward.height);
  const float off_x = dx + cell.sample(backward.xy.data(), 2);
  const float off_y = dy + cell.sample(backward.xy.data() + 1, 2);
  const float allowed = tolerance.least + tolerance.share * std::sqrt(dx * dx + dy * dy);
  return off_x * off_x + off_y * off_y <= allowed * allowed;
}

}  // namespace

Vec2 Flow::at(Vec2 p) const {
  const Cell cell = cell_at(float(p.x), float(p.y), width, height);
  return {double{cell.sample(xy.data(), 2)}, double{cell.sample(xy.data() + 1, 2)}};
}

std::vector<std::uint8_t> consistent(const Flow& forward, const Flow& backward, double least, double share) {
  check_sizes(forward, backward);
  const auto width = std::size_t(forward.width);
  const Tolerance tolerance{float(least), float(share)};
  std::vector<std::uint8_t> result(forward.xy.size() / 2);
  parallel_for(std::size_t(forward.height), [&](std::size_t y) {
    const float* d = forward.xy.data() + 2 * y * width;
    for (std::size_t x = 0; x < width; ++x) {
      const bool back =
          comes_back(backward, float(x) + 0.5F, float(y) + 0.5F, d[2 * x], d[2 * x + 1], tolerance);
      result[y * width + x] = back ? 1 : 0;
    }
  });
  return result;
}

}  // namespace knotreel::motion
