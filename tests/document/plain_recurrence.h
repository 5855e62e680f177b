// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

/// Simplex splines straight from the paper (Eq. 1, 2), for points in general position. Shares no code with
/// the library.
namespace knotreel::testing {

using Point = std::array<double, 2>;

inline double plain_area(Point a, Point b, Point c) {
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

/// M(u | knots), of degree knots.size() - 3.
inline double plain_simplex_spline(Point u, const std::vector<Point>& knots) {
  const std::size_t n = knots.size();
  // The triangle of largest area is the base of the recurrence.
  std::array<std::size_t, 3> base{0, 1, 2};
  double best = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        const double area = plain_area(knots[i], knots[j], knots[k]);
        if (area * area > best * best) {
          best = area;
          base = {i, j, k};
        }
      }
    }
  }
  if (best < 1e-9 && best > -1e-9) return 0;
  std::array<double, 3> weight{};
  for (std::size_t i = 0; i < 3; ++i) {
    weight[i] = plain_area(u, knots[base[(i + 1) % 3]], knots[base[(i + 2) % 3]]) / best;
  }
  if (n == 3) {
    const bool inside = weight[0] > 0 && weight[1] > 0 && weight[2] > 0;
    return inside ? 1 / (best < 0 ? -best : best) : 0;
  }
  double value = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<Point> rest = knots;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(base[i]));
    value += weight[i] * plain_simplex_spline(u, rest);
  }
  return value;
}

}  // namespace knotreel::testing
