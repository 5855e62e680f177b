// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/link_choice.h"

#include <limits>
#include <vector>

#include "knotreel/spline/link.h"

namespace knotreel::knots {

namespace {

constexpr double kLeastArea = 1e-6;  // flatter triangles cannot be part of a triangulation

/// Apexes of the best triangulation: apex(i, j) belongs to the triangle on the diagonal (i, j).
class PolygonProgramme {
 public:
  PolygonProgramme(std::span<const Vec2> polygon, const Target& target)
      : n_(polygon.size()), cost_(n_ * n_, 0), apex_(n_ * n_, 0) {
    for (std::size_t gap = 2; gap < n_; ++gap) {
      for (std::size_t i = 0; i + gap < n_; ++i) solve(polygon, target, i, i + gap);
    }
  }

  bool possible() const { return cost_[n_ - 1] < kImpossible; }

  void append_codes(std::size_t i, std::size_t j, std::vector<std::uint16_t>& codes) const {
    if (j - i <= 2) return;
    const std::size_t k = apex_[i * n_ + j];
    codes.push_back(static_cast<std::uint16_t>(k - (i + 1)));
    append_codes(i, k, codes);
    append_codes(k, j, codes);
  }

 private:
  static constexpr double kImpossible = std::numeric_limits<double>::infinity();

  void solve(std::span<const Vec2> p, const Target& target, std::size_t i, std::size_t j) {
    double best = kImpossible;
    for (std::size_t k = i + 1; k < j; ++k) {
      const double parts = cost_[i * n_ + k] + cost_[k * n_ + j];
      if (!(parts < best) || !(signed_area(p[i], p[k], p[j]) > kLeastArea)) continue;
      const double sum = parts + target.error({p[i], p[k], p[j]});
      if (sum < best) {
        best = sum;
        apex_[i * n_ + j] = k;
      }
    }
    cost_[i * n_ + j] = best;
  }

  std::size_t n_;
  std::vector<double> cost_;
  std::vector<std::size_t> apex_;
};

void append_standard(const spline::LinkPolygon& link, std::vector<std::uint16_t>& codes) {
  spline::encode_triangulation(link.positions.size(), spline::triangulate_polygon(link.positions), codes);
}

}  // namespace

spline::LinkPolicy picture_links(const Target& target, std::size_t most_corners) {
  return [&target, most_corners](const spline::LinkPolygon& link, std::vector<std::uint16_t>& codes) {
    if (link.positions.size() > most_corners) return append_standard(link, codes);
    const PolygonProgramme programme(link.positions, target);
    if (!programme.possible()) return append_standard(link, codes);
    programme.append_codes(0, link.positions.size() - 1, codes);
  };
}

}  // namespace knotreel::knots
