#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::fit {

namespace {

using spline::Basis;
using spline::BasisJet;

constexpr double kTolerance = 1e-4;  // pixels
constexpr int kMaxSteps = 8;
constexpr double kTraceStep = 0.2;  // pixels, along features

/// Functions with a displaced control point, and the pixels near them.
class Displaced {
 public:
  Displaced(const Basis& basis, std::span<const Vec2> displacement, int width, int height)
      : basis_(basis), width_(width), near_(std::size_t(width) * std::size_t(height), false) {
    const auto& space = basis.space();
    by_function_.resize(space.function_count());
    double reach = 0;
    for (std::size_t f = 0; f < by_function_.size(); ++f) {
      by_function_[f] = displacement[space.geometry_of()[f]];
      reach = std::max({reach, std::abs(by_function_[f].x), std::abs(by_function_[f].y)});
    }
    if (reach == 0) return;
    // S - identity is at most `reach`, so pixels this far from all displaced functions are their own places.
    for (const spline::Piece& piece : basis.pieces().pieces) {
      const bool any = std::any_of(piece.functions.begin(), piece.functions.end(), [&](auto f) {
        return f != spline::kNoFunction && by_function_[f] != Vec2{};
      });
      if (!any) continue;
      for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
        const spline::PieceTerm& term = basis.pieces().terms[t];
        const auto clamped = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, double(n))); };
        const int left = clamped(std::floor(term.low.x - reach), width);
        const int right = clamped(std::ceil(term.high.x + reach), width);
        const int bottom = clamped(std::ceil(term.high.y + reach), height);
        for (int y = clamped(std::floor(term.low.y - reach), height); y < bottom; ++y) {
          std::fill(near_.begin() + index(left, y), near_.begin() + index(right, y), true);
        }
      }
    }
  }

  bool near(int x, int y) const { return near_[static_cast<std::size_t>(index(x, y))]; }

  /// S_geo(u) - u and its derivative, columns by du and dv.
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

 private:
  std::ptrdiff_t index(int x, int y) const { return std::ptrdiff_t{y} * width_ + x; }

  const Basis& basis_;
  int width_;
  std::vector<bool> near_;
  std::vector<Vec2> by_function_;
};

Vec2 solve(const Displaced& geometry, Vec2 target, Vec2 start, double width, double height,
           std::vector<BasisJet>& jets) {
  Vec2 u = start;
  for (int i = 0; i < kMaxSteps; ++i) {
    const auto v = geometry.at(u, jets);
    const Vec2 miss = target - (u + v.offset);
    if (norm(miss) < kTolerance) return u;
    const Vec2 ex = Vec2{1, 0} + v.by_x;
    const Vec2 ey = Vec2{0, 1} + v.by_y;
    const double det = cross(ex, ey);
    Vec2 step = det > 0.1 ? Vec2{cross(miss, ey) / det, cross(ex, miss) / det} : miss;
    if (norm(step) > 1) step = (1 / norm(step)) * step;
    u = u + step;
    u = {std::clamp(u.x, 0.0, width), std::clamp(u.y, 0.0, height)};
  }
  return start;
}

}  // namespace

PixelPlaces invert_geometry(const Basis& basis, std::span<const Vec2> displacement, int width, int height,
                            std::span<const Vec2> start) {
  const auto& mesh = basis.space().mesh();
  const Displaced geometry(basis, displacement, width, height);
  PixelPlaces result;
  result.places.resize(std::size_t(width) * std::size_t(height));
  result.crossed.assign(result.places.size(), 0);
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    std::vector<BasisJet> jets;
    for (int x = 0; x < width; ++x) {
      const Vec2 centre{x + 0.5, y + 0.5};
      const std::size_t i = row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      result.places[i] = centre;
      if (!geometry.near(x, y)) continue;
      result.places[i] =
          solve(geometry, centre, start.empty() ? centre : start[i], mesh.width, mesh.height, jets);
    }
  });
  std::vector<BasisJet> jets;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 b = mesh.knots[s.knots.back()].position;
    const int samples = std::max(1, static_cast<int>(std::ceil(norm(b - a) / kTraceStep)));
    for (int k = 0; k <= samples; ++k) {
      const Vec2 u = a + (static_cast<double>(k) / samples) * (b - a);
      const Vec2 p = u + geometry.at(u, jets).offset;
      const int x = std::clamp(static_cast<int>(std::floor(p.x)), 0, width - 1);
      const int y = std::clamp(static_cast<int>(std::floor(p.y)), 0, height - 1);
      result.crossed[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)] = 1;
    }
  }
  return result;
}

}  // namespace knotreel::fit
