// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/smooth_vertices.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace knotreel::vectorize {

namespace {

constexpr std::ptrdiff_t kMostPoints = 10;  // on each side, to tell a bend from a corner by
constexpr std::ptrdiff_t kLeastPoints = 4;
constexpr double kMostChordTurn = 0.6;  // radians from the chord before to the one behind
constexpr double kNoise = 0.02;         // pixels, of points: that much may speak for a corner

/// Pixels where the curves have corners, or are rounded, ascending.
std::vector<std::int32_t> pixels_with(bool features::ChainPoint::*mark,
                                      const features::FeatureChains& chains) {
  std::vector<std::int32_t> pixels;
  for (const features::Chain& chain : chains.chains) {
    for (const features::ChainPoint& p : chain.points) {
      if (p.*mark) pixels.push_back(p.y * chains.width + p.x);
    }
  }
  std::sort(pixels.begin(), pixels.end());
  return pixels;
}

/// The points of a curve.
class Curve {
 public:
  Curve(std::span<const param::CurveSample> samples, bool closed) : samples_(samples), closed_(closed) {}

  bool is_smooth_at(std::size_t i) const {
    const auto n = static_cast<std::ptrdiff_t>(samples_.size());
    const auto at = static_cast<std::ptrdiff_t>(i);
    Reach reach{std::min(kMostPoints, closed_ ? (n - 1) / 2 : at),
                std::min(kMostPoints, closed_ ? (n - 1) / 2 : n - 1 - at)};
    while (std::min(reach.before, reach.behind) >= kLeastPoints && turn(at, reach) > kMostChordTurn)
      --(reach.before > reach.behind ? reach.before : reach.behind);
    if (std::min(reach.before, reach.behind) < kLeastPoints) return false;
    const auto points = static_cast<double>(reach.before + 1 + reach.behind);
    return missed_by(at, reach, [](double x) { return x * x; }) <=
           missed_by(at, reach, [](double x) { return std::abs(x); }) + points * kNoise * kNoise;
  }

 private:
  /// Points on both sides of one.
  struct Reach {
    std::ptrdiff_t before = 0, behind = 0;
  };

  Vec2 point(std::ptrdiff_t i) const {
    const auto n = static_cast<std::ptrdiff_t>(samples_.size());
    return samples_[static_cast<std::size_t>((i + n) % n)].position;
  }

  double turn(std::ptrdiff_t i, const Reach& reach) const {
    const Vec2 before = point(i) - point(i - reach.before), behind = point(i + reach.behind) - point(i);
    return std::abs(angle_between(before, behind));
  }

  /// Squared error of the best curve made of a line and a bend, over the chord.
  template <class Bend>
  double missed_by(std::ptrdiff_t i, const Reach& reach, const Bend& bend) const {
    const Vec2 chord = point(i + reach.behind) - point(i - reach.before);
    const Vec2 along = unit(chord);
    Eigen::MatrixX3d terms(reach.before + 1 + reach.behind, 3);
    Eigen::VectorXd heights(terms.rows());
    for (std::ptrdiff_t k = -reach.before; k <= reach.behind; ++k) {
      const Vec2 d = point(i + k) - point(i);
      const double x = dot(d, along);
      terms.row(k + reach.before) << 1, x, bend(x);
      heights[k + reach.before] = cross(along, d);
    }
    const Eigen::Vector3d best = (terms.transpose() * terms).ldlt().solve(terms.transpose() * heights);
    return (terms * best - heights).squaredNorm();
  }

  std::span<const param::CurveSample> samples_;
  bool closed_;
};

}  // namespace

std::vector<std::uint8_t> smooth_vertices(const param::Parametrization& map,
                                          const features::FeatureChains& chains) {
  const std::vector<std::int32_t> corners = pixels_with(&features::ChainPoint::corner, chains);
  const std::vector<std::int32_t> rounded = pixels_with(&features::ChainPoint::rounded, chains);
  const auto is_in = [](const std::vector<std::int32_t>& pixels, std::int32_t pixel) {
    return std::binary_search(pixels.begin(), pixels.end(), pixel);
  };
  const std::span<const param::CurveSample> all = map.curve_samples;
  std::vector<std::uint8_t> smooth(all.size(), 0);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].polyline == all[begin].polyline) ++end;
    const Curve curve(all.subspan(begin, end - begin), map.polylines[all[begin].polyline].closed);
    for (std::size_t i = begin; i < end; ++i) {
      if (all[i].t != 0 || is_in(corners, all[i].pixel)) continue;
      smooth[i] = is_in(rounded, all[i].pixel) || curve.is_smooth_at(i - begin) ? 1 : 0;
    }
  }
  return smooth;
}

}  // namespace knotreel::vectorize
