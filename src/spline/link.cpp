#include "knotreel/spline/link.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

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
  const auto key = [n](std::uint64_t i, std::uint64_t j) { return i * n + j; };
  std::unordered_map<std::uint64_t, std::uint32_t> apex;
  for (PolygonTriangle t : triangles) {
    std::sort(t.begin(), t.end());
    apex.emplace(key(t[0], t[2]), t[1]);
  }
  std::vector<Span> open{{0, static_cast<std::uint32_t>(n - 1)}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i <= 2) continue;
    const std::uint32_t k = apex.at(key(i, j));
    codes.push_back(static_cast<std::uint16_t>(k - i - 1));
    open.push_back({k, j});
    open.push_back({i, k});
  }
}

std::optional<std::size_t> decode_triangulation(std::size_t n, std::span<const std::uint16_t> codes,
                                                std::vector<PolygonTriangle>& triangles) {
  std::size_t used = 0;
  std::vector<Span> open{{0, static_cast<std::uint32_t>(n - 1)}};
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

std::vector<PolygonTriangle> triangulate_polygon(std::span<const Vec2> polygon) {
  std::vector<std::uint32_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0u);
  std::vector<PolygonTriangle> triangles;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t best = 0;
    double best_quality = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t a = left[(i + n - 1) % n];
      const std::uint32_t b = left[i];
      const std::uint32_t c = left[(i + 1) % n];
      double quality = smallest_angle(polygon[a], polygon[b], polygon[c]);
      const bool blocked = std::any_of(left.begin(), left.end(), [&](std::uint32_t p) {
        return p != a && p != b && p != c && inside(polygon[p], polygon[a], polygon[b], polygon[c]);
      });
      // Ears that are flat, turned, or hold another corner come last, the flattest first.
      if (quality <= 0 || blocked) quality = -1 - std::abs(quality);
      if (quality > best_quality) {
        best_quality = quality;
        best = i;
      }
    }
    triangles.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({left[0], left[1], left[2]});
  for (PolygonTriangle& t : triangles) std::sort(t.begin(), t.end());
  return triangles;
}

}  // namespace knotreel::spline
