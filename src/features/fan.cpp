// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/fan.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace knotreel::features {
namespace {

constexpr double kRadius = 2.3;          // px, of what is around a tip
constexpr double kLeastContrast = 8;     // levels
constexpr double kLeastAngle = 0.1;      // radians, between rays
constexpr double kLeastAreaShare = 0.1;  // of an area, its shares of pixels squared and summed
constexpr double kLineWeight = 0.2;      // of a px beside its ray, for a point; shares of pixels have 1
constexpr int kMostFanSteps = 10;
constexpr double kDamping = 1e-3;  // at first

/// A convex polygon that half-planes cut.
class Polygon {
 public:
  Polygon(double left, double top)
      : points_{Vec2{left, top}, {left + 1, top}, {left + 1, top + 1}, {left, top + 1}}, count_(4) {}

  /// Keeps what is to the left of the ray from p (seen with y up).
  void cut(Vec2 p, Vec2 ray) {
    std::array<Vec2, 8> kept;
    std::size_t count = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec2 a = points_[i];
      const Vec2 b = points_[(i + 1) % count_];
      const double da = cross(ray, a - p);
      const double db = cross(ray, b - p);
      if (da >= 0) kept[count++] = a;
      if ((da >= 0) != (db >= 0)) kept[count++] = a + (da / (da - db)) * (b - a);
    }
    points_ = kept;
    count_ = count;
  }

  double area() const {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < count_; ++i) sum += signed_area(points_[0], points_[i], points_[i + 1]);
    return std::abs(sum);
  }

 private:
  std::array<Vec2, 8> points_;
  std::size_t count_;
};

enum class Side { kLeft, kRight, kBoth };

/// Where the unit square with that top left corner is, seen along the ray from p.
Side side_of(Vec2 p, Vec2 ray, double left, double top) {
  int to_the_left = 0;
  for (const Vec2 corner : {Vec2{left, top}, {left + 1, top}, {left + 1, top + 1}, {left, top + 1}})
    to_the_left += cross(ray, corner - p) >= 0 ? 1 : 0;
  return to_the_left == 4 ? Side::kLeft : to_the_left == 0 ? Side::kRight : Side::kBoth;
}

/// From one ray to the other, less than half a turn. Most squares are on one side of both.
double share_between(Vec2 tip, Vec2 from, Vec2 to, double left, double top) {
  const Side of_from = side_of(tip, from, left, top);
  const Side of_to = side_of(tip, -1.0 * to, left, top);
  if (of_from == Side::kRight || of_to == Side::kRight) return 0;
  if (of_from == Side::kLeft && of_to == Side::kLeft) return 1;
  Polygon square(left, top);
  square.cut(tip, from);
  square.cut(tip, -1.0 * to);
  return square.area();
}

/// 0..2 pi.
double angle_on(Vec2 from, Vec2 to) {
  const double angle = angle_between(from, to);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

/// @param change  of the tip, and of the angle of each ray
Fan changed(Fan fan, const Eigen::VectorXd& change) {
  fan.tip = fan.tip + Vec2{change[0], change[1]};
  for (std::size_t i = 0; i < fan.rays.size(); ++i)
    fan.rays[i] = turned(fan.rays[i], change[Eigen::Index(i) + 2]);
  return fan;
}

/// Rays are in order and apart, and at most one area is of half a turn or more.
bool is_sound(const Fan& fan) {
  double all = 0;
  int wide = 0;
  for (std::size_t i = 0; i < fan.rays.size(); ++i) {
    const Vec2 from = fan.rays[i];
    const Vec2 to = fan.rays[(i + 1) % fan.rays.size()];
    const double angle = angle_on(from, to);
    if (angle < kLeastAngle) return false;
    all += angle;
    wide += cross(from, to) <= 0 ? 1 : 0;
  }
  return all < 2 * std::numbers::pi + kLeastAngle && wide <= 1;
}

/// Least squares for the fan, by steps of Levenberg and Marquardt; colours follow from it (variable
/// projection).
class FanFitter {
 public:
  FanFitter(const image::Image& image, FanWindow window, Vec2 tip, const std::vector<Vec2>& through)
      : through_(through) {
    for (int y = window.y; y < window.y + FanWindow::kSize; ++y) {
      for (int x = window.x; x < window.x + FanWindow::kSize; ++x) {
        if (norm(Vec2{x + 0.5, y + 0.5} - tip) <= kRadius) pixels_.push_back({double(x), double(y)});
      }
    }
    samples_.resize(Eigen::Index(pixels_.size()), image.channels);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const int x = int(pixels_[i].x);
      const int y = int(pixels_[i].y);
      const double alpha = image.has_alpha() ? double{image.at(x, y, image.channels - 1)} / 255 : 1.0;
      for (int c = 0; c < image.channels; ++c) {
        const double v = c < image.colour_channels() ? double{image.at(x, y, c)} : 255.0;
        samples_(Eigen::Index(i), c) = alpha * v;
      }
    }
  }

  std::optional<FanFit> run(const Fan& start) {
    State best = evaluate(start);
    if (!best.valid) return std::nullopt;
    line_weight_ = kLineWeight * differences(best);
    best = evaluate(start);
    double damping = kDamping;
    for (int step = 0; step < kMostFanSteps; ++step) {
      State next = evaluate(changed(best.fan, change_from(best, damping)));
      const bool better = next.valid && next.cost < best.cost;
      damping *= better ? 0.1 : 10;
      if (!better) continue;
      const bool done = next.cost > 0.99 * best.cost;
      best = std::move(next);
      if (done) break;
    }
    const double contrast = differences(best);
    if (contrast < kLeastContrast) return std::nullopt;
    return FanFit{best.fan, std::sqrt(best.left / double(pixels_.size())) / contrast};
  }

 private:
  struct State {
    bool valid = false;
    Fan fan;
    Eigen::MatrixXd shares;  // by pixels and areas
    Eigen::LDLT<Eigen::MatrixXd> normal;
    Eigen::MatrixXd colours;  // by areas and channels
    Eigen::MatrixXd residual;
    Eigen::VectorXd beside;  // distances of rays from their points, px
    double left = 0;         // levels, squared and summed
    double cost = 0;         // the same, with those distances
  };

  Eigen::MatrixXd shares_in(const Fan& fan) const {
    Eigen::MatrixXd shares(Eigen::Index(fan.rays.size()), Eigen::Index(pixels_.size()));
    for (std::size_t i = 0; i < pixels_.size(); ++i)
      shares_of(fan, pixels_[i].x, pixels_[i].y, shares.col(Eigen::Index(i)).data());
    return shares.transpose();
  }

  Eigen::VectorXd beside(const Fan& fan) const {
    Eigen::VectorXd distances(Eigen::Index(fan.rays.size()));
    for (std::size_t i = 0; i < through_.size(); ++i)
      distances[Eigen::Index(i)] = cross(fan.rays[i], through_[i] - fan.tip);
    return distances;
  }

  State evaluate(Fan fan) const {
    State s;
    if (!is_sound(fan)) return s;
    s.shares = shares_in(fan);
    s.fan = std::move(fan);
    if (s.shares.colwise().squaredNorm().minCoeff() < kLeastAreaShare) return s;
    s.valid = true;
    s.normal.compute(s.shares.transpose() * s.shares);
    s.colours = s.normal.solve(s.shares.transpose() * samples_);
    s.residual = samples_ - s.shares * s.colours;
    s.left = s.residual.squaredNorm();
    s.beside = beside(s.fan);
    s.cost = s.left + line_weight_ * line_weight_ * s.beside.squaredNorm();
    return s;
  }

  /// Root mean square of the differences across the rays.
  double differences(const State& s) const {
    const Eigen::Index n = s.colours.rows();
    double sum = 0;
    for (Eigen::Index i = 0; i < n; ++i) sum += (s.colours.row((i + 1) % n) - s.colours.row(i)).squaredNorm();
    return std::sqrt(sum / double(n));
  }

  Eigen::VectorXd change_from(const State& s, double damping) const {
    constexpr double kDifference = 0.02;  // px and radians
    const Eigen::Index n = s.shares.cols() + 2;
    const double contrast = differences(s);
    Eigen::MatrixXd normal = damping * contrast * contrast * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::MatrixXd> slopes;  // of what is drawn, by pixels and channels
    Eigen::MatrixXd beside_slopes(n - 2, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::VectorXd d = kDifference * Eigen::VectorXd::Unit(n, k);
      const Fan more = changed(s.fan, d);
      const Fan less = changed(s.fan, -d);
      beside_slopes.col(k) = (beside(more) - beside(less)) / (2 * kDifference);
      Eigen::MatrixXd slope = (shares_in(more) - shares_in(less)) * s.colours / (2 * kDifference);
      // What other colours would do as well is not for the fan.
      slope -= s.shares * s.normal.solve(s.shares.transpose() * slope);
      slopes.push_back(std::move(slope));
    }
    for (Eigen::Index k = 0; k < n; ++k) {
      right[k] = slopes[std::size_t(k)].cwiseProduct(s.residual).sum();
      for (Eigen::Index l = 0; l < n; ++l)
        normal(k, l) += slopes[std::size_t(k)].cwiseProduct(slopes[std::size_t(l)]).sum();
    }
    const double weight = line_weight_ * line_weight_;
    normal += weight * beside_slopes.transpose() * beside_slopes;
    right -= weight * beside_slopes.transpose() * s.beside;
    return normal.ldlt().solve(right);
  }

  const std::vector<Vec2>& through_;
  double line_weight_ = 0;    // levels per px
  std::vector<Vec2> pixels_;  // their top left corners
  Eigen::MatrixXd samples_;   // by pixels and channels
};

}  // namespace

void shares_of(const Fan& fan, double left, double top, double* shares) {
  const std::size_t n = fan.rays.size();
  std::size_t widest = n;  // of half a turn or more, if there is one
  double rest = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 from = fan.rays[i];
    const Vec2 to = fan.rays[(i + 1) % n];
    if (cross(from, to) <= 0) {
      widest = i;
      continue;
    }
    shares[i] = share_between(fan.tip, from, to, left, top);
    rest -= shares[i];
  }
  if (widest < n) shares[widest] = rest;
}

std::optional<FanWindow> fan_window(const image::Image& image, Vec2 tip) {
  constexpr int kHalf = FanWindow::kSize / 2;
  const double x = std::floor(tip.x) - kHalf;
  const double y = std::floor(tip.y) - kHalf;
  if (!(x >= 0 && y >= 0 && x + FanWindow::kSize <= image.width && y + FanWindow::kSize <= image.height))
    return std::nullopt;
  return FanWindow{int(x), int(y)};
}

std::optional<FanFit> fit_fan(const image::Image& image, const Fan& start, const std::vector<Vec2>& through) {
  const std::optional<FanWindow> window = fan_window(image, start.tip);
  if (!window) return std::nullopt;
  return FanFitter(image, *window, start.tip, through).run(start);
}

}  // namespace knotreel::features
