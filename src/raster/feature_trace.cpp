// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/feature_trace.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>

#include "knotreel/spline/pixel_tiles.h"

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

/// Whether the image of the way from a to b may lie in some of the tiles.
bool comes_near(const Surface& surface, Vec2 a, Vec2 b, std::span<const std::uint8_t> tiles) {
  const Surface::Bounds moves = surface.displacement_bounds();
  const auto tile = [](double v, double size) {
    return static_cast<std::size_t>(std::clamp(v, 0.0, size - 1)) / spline::PixelTiles::kSide;
  };
  const std::size_t columns = tile(surface.width(), surface.width()) + 1;
  const std::size_t left = tile(std::min(a.x, b.x) + moves.low.x, surface.width());
  const std::size_t right = tile(std::max(a.x, b.x) + moves.high.x, surface.width());
  const std::size_t bottom = tile(std::max(a.y, b.y) + moves.high.y, surface.height());
  for (std::size_t y = tile(std::min(a.y, b.y) + moves.low.y, surface.height()); y <= bottom; ++y) {
    for (std::size_t x = left; x <= right; ++x) {
      if (tiles[y * columns + x]) return true;
    }
  }
  return false;
}

}  // namespace

FeatureTrace::FeatureTrace(const Surface& surface, const mesh::KnotMesh& mesh,
                           std::span<const std::uint8_t> tiles) {
  const auto image = [&](Vec2 a, Vec2 b, double t) {
    const Vec2 u = a + t * (b - a);
    return u + surface.evaluate(u).displacement;
  };
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 1; i < s.knots.size(); ++i) {
      const Vec2 a = mesh.knots[s.knots[i - 1]].position;
      const Vec2 b = mesh.knots[s.knots[i]].position;
      if (!tiles.empty() && !comes_near(surface, a, b, tiles)) continue;
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

/// Collects the pixels of one region of a grid that curves cross.
class FeatureTrace::PixelWalk {
 public:
  PixelWalk(int row_begin, int row_end, int column_begin, int column_end)
      : row_begin_(row_begin), row_end_(row_end), column_begin_(column_begin), column_end_(column_end) {}

  /// Halves the curve (in grid pixels) until its parts are chords; parts outside the region are left alone,
  /// so that the work does not grow with what cannot be seen.
  void add(const Curve& curve, int depth = 0) {
    const auto last = static_cast<std::size_t>(curve.degree);
    Vec2 low = curve.control[0];
    Vec2 high = low;
    double length = 0;
    for (std::size_t i = 1; i <= last; ++i) {
      const Vec2 p = curve.control[i];
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      length += norm(p - curve.control[i - 1]);
    }
    if (!(high.x >= column_begin_ && low.x < column_end_ && high.y >= row_begin_ && low.y < row_end_)) return;
    if (length <= kChord || depth == kMaxDepth) {
      add_chord(curve.control[0], curve.control[last]);
      return;
    }
    const auto [left, right] = curve.halves();
    add(left, depth + 1);
    add(right, depth + 1);
  }

  std::vector<CrossedPixel> pixels() {
    std::sort(meetings_.begin(), meetings_.end());
    std::vector<CrossedPixel> result;
    std::vector<Chord> chords;
    for (std::size_t i = 0; i < meetings_.size();) {
      const auto [y, x, first] = meetings_[i];
      chords.clear();
      for (; i < meetings_.size() && meetings_[i].y == y && meetings_[i].x == x; ++i)
        chords.push_back(chords_[meetings_[i].chord]);
      result.push_back({x, y, split_pixel(chords, x, y)});
    }
    return result;
  }

 private:
  static constexpr double kChord = 0.5;  // longest, in grid pixels
  static constexpr int kMaxDepth = 48;   // halves any finite length that matters to below a chord

  /// Of a chord with a pixel.
  struct Meeting {
    int y;
    int x;
    std::uint32_t chord;

    auto operator<=>(const Meeting&) const = default;
  };

  void add_chord(Vec2 from, Vec2 to) {
    const auto pixel = [](double v, int low, int high) {
      return static_cast<int>(std::clamp(std::floor(v), static_cast<double>(low), static_cast<double>(high)));
    };
    const int y1 = pixel(std::max(from.y, to.y), row_begin_, row_end_ - 1);
    const int x1 = pixel(std::max(from.x, to.x), column_begin_, column_end_ - 1);
    for (int y = pixel(std::min(from.y, to.y), row_begin_, row_end_ - 1); y <= y1; ++y) {
      for (int x = pixel(std::min(from.x, to.x), column_begin_, column_end_ - 1); x <= x1; ++x) {
        if (crosses(from, to, x, y)) meetings_.push_back({y, x, static_cast<std::uint32_t>(chords_.size())});
      }
    }
    chords_.push_back({from, to});
  }

  int row_begin_;
  int row_end_;
  int column_begin_;
  int column_end_;
  std::vector<Chord> chords_;
  std::vector<Meeting> meetings_;
};

std::pair<FeatureTrace::Curve, FeatureTrace::Curve> FeatureTrace::Curve::halves() const {
  Curve left{control, degree};
  Curve right{control, degree};
  for (int level = degree; level > 0; --level) {
    for (int i = 0; i < level; ++i) {
      const auto k = static_cast<std::size_t>(i);
      right.control[k] = 0.5 * (right.control[k] + right.control[k + 1]);
    }
    left.control[static_cast<std::size_t>(degree - level + 1)] = right.control[0];
  }
  return {left, right};
}

std::vector<CrossedPixel> FeatureTrace::crossed_pixels(double pixel_width, double pixel_height, int row_begin,
                                                       int row_end, int column_begin, int column_end) const {
  PixelWalk walk(row_begin, row_end, column_begin, column_end);
  for (Curve curve : curves_) {
    for (Vec2& c : curve.control) c = {c.x / pixel_width, c.y / pixel_height};
    walk.add(curve);
  }
  return walk.pixels();
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
