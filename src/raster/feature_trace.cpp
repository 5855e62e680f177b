#include "raster/feature_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knotreel::raster {

namespace {

/// Whether the chord a-b meets the unit square of pixel (x, y).
bool crosses(Vec2 a, Vec2 b, int x, int y) {
  double enter = 0;
  double leave = 1;
  const auto clip = [&](double from, double step, double low) {
    if (step == 0) return from >= low && from <= low + 1;
    const double t0 = (low - from) / step;
    const double t1 = (low + 1 - from) / step;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
    return true;
  };
  return clip(a.x, b.x - a.x, x) && clip(a.y, b.y - a.y, y) && enter <= leave;
}

}  // namespace

FeatureTrace::FeatureTrace(const Surface& surface, const mesh::KnotMesh& mesh) {
  const auto image = [&](Vec2 a, Vec2 b, double t) {
    const Vec2 u = a + t * (b - a);
    return u + surface.evaluate(u).displacement;
  };
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 1; i < s.knots.size(); ++i) {
      const Vec2 a = mesh.knots[s.knots[i - 1]].position;
      const Vec2 b = mesh.knots[s.knots[i]].position;
      Curve curve{{}, surface.degree()};
      const Vec2 p0 = image(a, b, 0);
      const Vec2 p1 = image(a, b, 1);
      if (curve.degree == 1) {
        curve.control = {p0, p1};
      } else if (curve.degree == 2) {
        curve.control = {p0, 2 * image(a, b, 0.5) - 0.5 * (p0 + p1), p1};
      } else {
        const Vec2 q0 = image(a, b, 1.0 / 3);
        const Vec2 q1 = image(a, b, 2.0 / 3);
        const Vec2 c1 = (1.0 / 6) * (-5 * p0 + 18 * q0 - 9 * q1 + 2 * p1);
        const Vec2 c2 = (1.0 / 6) * (2 * p0 - 9 * q0 + 18 * q1 - 5 * p1);
        curve.control = {p0, c1, c2, p1};
      }
      curves_.push_back(curve);
    }
  }
}

Vec2 FeatureTrace::Curve::at(double t) const {
  std::array<Vec2, 4> p = control;
  for (int level = degree; level > 0; --level) {
    for (int i = 0; i < level; ++i) {
      const auto k = static_cast<std::size_t>(i);
      p[k] = (1 - t) * p[k] + t * p[k + 1];
    }
  }
  return p[0];
}

std::vector<std::uint64_t> FeatureTrace::crossed_pixels(double pixel_width, double pixel_height,
                                                        int row_begin, int row_end, int column_begin,
                                                        int column_end) const {
  constexpr double kStep = 0.5;  // longest chord, in grid pixels
  std::vector<std::uint64_t> keys;
  for (const Curve& curve : curves_) {
    std::array<Vec2, 4> c = curve.control;
    const auto last = static_cast<std::size_t>(curve.degree);
    double length = 0;
    double top = std::numeric_limits<double>::infinity();
    double bottom = -top;
    for (std::size_t i = 0; i <= last; ++i) {
      c[i] = {c[i].x / pixel_width, c[i].y / pixel_height};
      top = std::min(top, c[i].y);
      bottom = std::max(bottom, c[i].y);
      if (i > 0) length += norm(c[i] - c[i - 1]);
    }
    if (bottom < row_begin || top >= row_end) continue;
    const Curve scaled{c, curve.degree};
    // Bounded whatever the control points say.
    const auto steps = static_cast<int>(std::min(std::ceil(length / kStep) + 1, 4e6));
    Vec2 from = scaled.at(0);
    for (int i = 1; i <= steps; ++i) {
      const Vec2 to = scaled.at(static_cast<double>(i) / steps);
      const auto clamp = [](double v, int low, int high) {
        return static_cast<int>(std::clamp(std::floor(v), low - 1.0, static_cast<double>(high)));
      };
      const int x0 = std::max(clamp(std::min(from.x, to.x), column_begin, column_end), column_begin);
      const int x1 = std::min(clamp(std::max(from.x, to.x), column_begin, column_end), column_end - 1);
      const int y0 = std::max(clamp(std::min(from.y, to.y), row_begin, row_end), row_begin);
      const int y1 = std::min(clamp(std::max(from.y, to.y), row_begin, row_end), row_end - 1);
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          if (!crosses(from, to, x, y)) continue;
          keys.push_back((static_cast<std::uint64_t>(y) << 32) | static_cast<std::uint32_t>(x));
        }
      }
      from = to;
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

double FeatureTrace::distance(Vec2 x, int steps) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Curve& curve : curves_) {
    Vec2 from = curve.at(0);
    for (int i = 1; i <= steps; ++i) {
      const Vec2 to = curve.at(static_cast<double>(i) / steps);
      const Vec2 e = to - from;
      const double length2 = dot(e, e);
      const double t = length2 > 0 ? std::clamp(dot(x - from, e) / length2, 0.0, 1.0) : 0.0;
      best = std::min(best, norm(x - (from + t * e)));
      from = to;
    }
  }
  return best;
}

}  // namespace knotreel::raster
