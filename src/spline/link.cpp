// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/link.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/small_vector.h"
#include "knotreel/base/error.h"

namespace knotreel::spline {

namespace {

using Span = std::pair<std::uint32_t, std::uint32_t>;

/// Sine-like measure of the smallest angle of a triangle: twice the area over the largest product of two
/// sides; not positive for flat and turned triangles.
double smallest_angle(Vec2 a, Vec2 b, Vec2 c) {
  const double ab = norm(b - a);
  const double bc = norm(c - b);
  const double ca = norm(a - c);
  const double product = std::max({ab * bc, bc * ca, ca * ab});
  return product > 0 ? 2 * signed_area(a, b, c) / product : 0;
}

bool inside(Vec2 p, Vec2 a, Vec2 b, Vec2 c) {
  return signed_area(a, b, p) >= 0 && signed_area(b, c, p) >= 0 && signed_area(c, a, p) >= 0;
}

}  // namespace

void encode_triangulation(std::size_t n, std::span<const PolygonTriangle> triangles,
                          std::vector<std::uint16_t>& codes) {
  // By the edge between the outer two corners, on which the one in between is the apex.
  struct Apex {
    Span edge;
    std::uint32_t corner;
  };
  SmallVector<Apex, 8> apexes;
  for (PolygonTriangle t : triangles) {
    std::sort(t.begin(), t.end());
    apexes.push_back({{t[0], t[2]}, t[1]});
  }
  std::sort(apexes.begin(), apexes.end(), [](const Apex& a, const Apex& b) { return a.edge < b.edge; });
  SmallVector<Span, 8> open;
  open.push_back({0, static_cast<std::uint32_t>(n - 1)});
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i <= 2) continue;
    const Span edge{i, j};
    const std::uint32_t k =
        std::lower_bound(apexes.begin(), apexes.end(), edge, [](const Apex& a, const Span& e) {
          return a.edge < e;
        })->corner;
    codes.push_back(static_cast<std::uint16_t>(k - i - 1));
    open.push_back({k, j});
    open.push_back({i, k});
  }
}

std::optional<std::size_t> decode_triangulation(std::size_t n, std::span<const std::uint16_t> codes,
                                                std::vector<PolygonTriangle>& triangles) {
  std::size_t used = 0;
  SmallVector<Span, 8> open;
  open.push_back({0, static_cast<std::uint32_t>(n - 1)});
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    std::uint32_t k = i + 1;
    if (j - i > 2) {
      if (used == codes.size()) return std::nullopt;
      k += codes[used++];
      if (k >= j) return std::nullopt;
    }
    triangles.push_back({i, k, j});
    open.push_back({k, j});
    open.push_back({i, k});
  }
  return used;
}

namespace {

/// Cuts ears off a polygon, the best first.
class EarCutter {
 public:
  explicit EarCutter(std::span<const Vec2> polygon) : polygon_(polygon), left_(polygon.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
    rate_all();
  }

  std::vector<PolygonTriangle> run() {
    std::vector<PolygonTriangle> triangles;
    while (left_.size() > 3) {
      std::size_t best = best_ear();
      // A corner that is gone may have been all that blocked an ear.
      if (quality_[best] <= -1 && stale_) {
        rate_all();
        best = best_ear();
      }
      const std::size_t n = left_.size();
      triangles.push_back({left_[(best + n - 1) % n], left_[best], left_[(best + 1) % n]});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best));
      quality_.erase(quality_.begin() + static_cast<std::ptrdiff_t>(best));
      stale_ = true;
      rate((best + n - 2) % (n - 1));
      rate(best % (n - 1));
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    for (PolygonTriangle& t : triangles) std::sort(t.begin(), t.end());
    return triangles;
  }

 private:
  std::size_t best_ear() const {
    return static_cast<std::size_t>(std::max_element(quality_.begin(), quality_.end()) - quality_.begin());
  }

  void rate_all() {
    quality_.resize(left_.size());
    for (std::size_t i = 0; i < left_.size(); ++i) rate(i);
    stale_ = false;
  }

  /// The smallest angle of a proper ear; ears that are flat, turned, or hold another corner come last, below
  /// -1, the flattest first.
  void rate(std::size_t i) {
    const std::size_t n = left_.size();
    const std::uint32_t a = left_[(i + n - 1) % n];
    const std::uint32_t b = left_[i];
    const std::uint32_t c = left_[(i + 1) % n];
    const double angle = smallest_angle(polygon_[a], polygon_[b], polygon_[c]);
    const bool proper =
        angle > 0 && std::none_of(left_.begin(), left_.end(), [&](std::uint32_t p) {
          return p != a && p != b && p != c && inside(polygon_[p], polygon_[a], polygon_[b], polygon_[c]);
        });
    quality_[i] = proper ? angle : -1 - std::abs(angle);
  }

  std::span<const Vec2> polygon_;
  std::vector<std::uint32_t> left_;
  std::vector<double> quality_;
  bool stale_ = false;  ///< ears may have become proper since they were rated
};

// Links have about six corners; one of this size comes from a file made to keep us busy.
constexpr std::size_t kMaxPolygon = 4096;

}  // namespace

std::vector<PolygonTriangle> triangulate_polygon(std::span<const Vec2> polygon) {
  if (polygon.size() > kMaxPolygon) {
    throw Error(ErrorKind::kInvalidArgument, "a link with more than 4096 corners cannot be triangulated");
  }
  return EarCutter(polygon).run();
}

}  // namespace knotreel::spline
