// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/crossed_pixels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knotreel::param {
namespace {

/// Lines along the edge of two squares, or nearly so, count for both.
constexpr double kSlack = 1e-9;

struct PixelRange {
  int first, last;
};

PixelRange pixels_between(double low, double high, int size) {
  return {std::max(0, static_cast<int>(std::floor(low - kSlack))),
          std::min(size - 1, static_cast<int>(std::floor(high + kSlack)))};
}

void clear_along(Vec2 a, Vec2 b, int width, int height, std::vector<float>& weights) {
  if (a.y > b.y) std::swap(a, b);
  const PixelRange rows = pixels_between(a.y, b.y, height);
  for (int y = rows.first; y <= rows.last; ++y) {
    // The part of the segment within the row, which may reach beyond by the slack only.
    double from = a.x;
    double to = b.x;
    if (b.y > a.y) {
      const double slope = (b.x - a.x) / (b.y - a.y);
      if (a.y < y - kSlack) from = a.x + (y - kSlack - a.y) * slope;
      if (b.y > y + 1 + kSlack) to = a.x + (y + 1 + kSlack - a.y) * slope;
    }
    const PixelRange columns = pixels_between(std::min(from, to), std::max(from, to), width);
    for (int x = columns.first; x <= columns.last; ++x) {
      weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          0;
    }
  }
}

}  // namespace

void clear_crossed_pixels(const Parametrization& p, std::vector<float>& weights) {
  for (const Polyline& line : p.polylines) {
    const std::size_t n = line.vertices.size();
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
      clear_along(p.vertices[line.vertices[i]].position, p.vertices[line.vertices[(i + 1) % n]].position,
                  p.width, p.height, weights);
    }
  }
}

}  // namespace knotreel::param
