#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::fit {

namespace {

using spline::Basis;
using spline::BasisJet;

constexpr double kTolerance = 1e-3;  // pixels
// A fixed point step from closer than this ends within a hundredth of a pixel, since the displacement changes
// by less than a fifth of a pixel per pixel nearly everywhere.
constexpr double kOneStep = 0.05;
constexpr int kMaxSteps = 8;
constexpr double kTraceSpacing = 1.0;  // of places along features at which the geometry is looked up, pixels
constexpr double kTraceStep = 0.2;     // pixels, between them

/// The geometry part: S_geo(u) - u.
class Geometry {
 public:
  Geometry(const Basis& basis, std::span<const Vec2> displacement) : basis_(basis) {
    const auto& space = basis.space();
    by_function_.resize(space.function_count());
    for (std::size_t f = 0; f < by_function_.size(); ++f)
      by_function_[f] = displacement[space.geometry_of()[f]];
  }

  const std::vector<Vec2>& by_function() const { return by_function_; }

  /// Offset and its derivatives.
  struct Value {
    Vec2 offset, by_x, by_y;
  };
  Value at(Vec2 u, std::vector<BasisJet>& jets) const {
    const auto& mesh = basis_.space().mesh();
    basis_.evaluate(u, spline::inward_direction(u, mesh.width, mesh.height), jets);
    Value v;
    for (const BasisJet& j : jets) {
      const Vec2 d = by_function_[j.function];
      v.offset = v.offset + j.jet.value * d;
      v.by_x = v.by_x + j.jet.dx * d;
      v.by_y = v.by_y + j.jet.dy * d;
    }
    return v;
  }

  Vec2 clamped(Vec2 u) const {
    const auto& mesh = basis_.space().mesh();
    return {std::clamp(u.x, 0.0, mesh.width), std::clamp(u.y, 0.0, mesh.height)};
  }

  /// Newton's method; `start` if it fails.
  Vec2 place_of(Vec2 target, Vec2 start, std::vector<BasisJet>& jets) const {
    Vec2 u = start;
    for (int i = 0; i < kMaxSteps; ++i) {
      const Value v = at(u, jets);
      const Vec2 miss = target - (u + v.offset);
      if (norm(miss) < kTolerance) return u;
      const Vec2 ex = Vec2{1, 0} + v.by_x;
      const Vec2 ey = Vec2{0, 1} + v.by_y;
      const double det = cross(ex, ey);
      Vec2 step = det > 0.1 ? Vec2{cross(miss, ey) / det, cross(ex, miss) / det} : miss;
      if (norm(step) > 1) step = (1 / norm(step)) * step;
      u = clamped(u + step);
    }
    return start;
  }

 private:
  const Basis& basis_;
  std::vector<Vec2> by_function_;
};

}  // namespace

std::vector<Vec2> image_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                               std::vector<Vec2> points) {
  const spline::ScatteredValues values = basis.evaluate(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = values.begin[i]; j < values.begin[i + 1]; ++j) {
      const spline::BasisValue& v = values.values[j];
      points[i] = points[i] + v.value * displacement[basis.space().geometry_of()[v.function]];
    }
  }
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

PixelPlaces invert_geometry(const spline::PixelValues& values, std::span<const Vec2> displacement,
                            std::span<const Vec2> start) {
  const Geometry geometry(values.basis(), displacement);
  const int width = values.width();
  const int height = values.height();
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  std::vector<double> offsets(2 * pixels);
  std::vector<double> control(2 * geometry.by_function().size());
  for (std::size_t f = 0; f < geometry.by_function().size(); ++f) {
    control[2 * f] = geometry.by_function()[f].x;
    control[2 * f + 1] = geometry.by_function()[f].y;
  }
  spline::surface_at_pixels(values, control, 2, offsets);

  PixelPlaces result;
  result.places.resize(pixels);
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    std::vector<BasisJet> jets;
    for (std::size_t i = y * std::size_t(width); i < (y + 1) * std::size_t(width); ++i) {
      const Vec2 centre{static_cast<double>(i % std::size_t(width)) + 0.5, static_cast<double>(y) + 0.5};
      const Vec2 at = start.empty() ? centre : start[i];
      const Vec2 offset{offsets[2 * i], offsets[2 * i + 1]};
      if (offset == Vec2{} && norm(at - centre) < 0.5) {
        result.places[i] = centre;  // the identity holds around here
        continue;
      }
      const Vec2 miss = centre - (at + offset);
      const Vec2 next = geometry.clamped(at + miss);
      result.places[i] = norm(miss) < kOneStep ? next : geometry.place_of(centre, next, jets);
    }
  });
  result.crossed = crossed_pixels(values.basis(), displacement, width, height);
  return result;
}

}  // namespace knotreel::fit
