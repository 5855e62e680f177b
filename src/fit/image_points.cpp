// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "fit/geometry_map.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/spline/surface.h"

namespace knotreel::fit {

namespace {

constexpr double kTraceSpacing = 1.0;  // of places along features at which the geometry is looked up, pixels
constexpr double kTraceStep = 0.2;     // pixels, between them

}  // namespace

std::vector<Vec2> image_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                               std::vector<Vec2> points) {
  const std::vector<double> control = displacement_control(basis.space(), displacement);
  std::vector<double> moves(2 * points.size());
  spline::surface_at_points(basis, {control, 2}, points, moves);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = points[i] + Vec2{moves[2 * i], moves[2 * i + 1]};
  return points;
}

std::vector<std::uint8_t> crossed_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                                         int width, int height) {
  const auto& mesh = basis.space().mesh();
  std::vector<Vec2> points;
  std::vector<std::size_t> ends;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 along = mesh.knots[s.knots.back()].position - a;
    const int n = std::max(1, static_cast<int>(std::ceil(norm(along) / kTraceSpacing)));
    for (int i = 0; i <= n; ++i) points.push_back(a + (static_cast<double>(i) / n) * along);
    ends.push_back(points.size());
  }
  points = image_points(basis, displacement, std::move(points));
  std::vector<std::uint8_t> crossed(std::size_t(width) * std::size_t(height), 0);
  std::size_t i = 0;
  for (const std::size_t end : ends) {
    for (; i + 1 < end; ++i) {
      const Vec2 step = points[i + 1] - points[i];
      const int n = std::max(1, static_cast<int>(std::ceil(norm(step) / kTraceStep)));
      for (int k = 0; k <= n; ++k) {
        const Vec2 p = points[i] + (static_cast<double>(k) / n) * step;
        const int x = std::clamp(static_cast<int>(std::floor(p.x)), 0, width - 1);
        const int y = std::clamp(static_cast<int>(std::floor(p.y)), 0, height - 1);
        crossed[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
      }
    }
    i = end;
  }
  return crossed;
}

}  // namespace knotreel::fit
