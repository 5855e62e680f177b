// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/fit_curve.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace knotreel::exporting {

namespace {

// Curves that meet at a larger angle than that, in radians, form a corner.
constexpr double kCorner = 0.2;
constexpr int kSamples = 6;      ///< of a curve, its end included
constexpr int kCorrections = 4;  ///< of the parameters of samples
// Longer stretches are cut: both ways of simplifying look at all of a stretch for each part that it falls
// into.
constexpr std::size_t kLongest = 512;

Vec2 at(const Curve& c, double t) {
  const double s = 1 - t;
  return (s * s * s) * c[0] + (3 * s * s * t) * c[1] + (3 * s * t * t) * c[2] + (t * t * t) * c[3];
}

Vec2 derivative(const Curve& c, double t) {
  const double s = 1 - t;
  return (3 * s * s) * (c[1] - c[0]) + (6 * s * t) * (c[2] - c[1]) + (3 * t * t) * (c[3] - c[2]);
}

Vec2 second_derivative(const Curve& c, double t) {
  return (6 * (1 - t)) * (c[2] - 2 * c[1] + c[0]) + (6 * t) * (c[3] - 2 * c[2] + c[1]);
}

/// The direction at t, or that of the chord where the curve stands still.
Vec2 direction(const Curve& c, double t) {
  Vec2 d = derivative(c, t);
  if (norm(d) < 1e-9) d = t < 0.5 ? c[2] - c[0] : c[3] - c[1];
  if (norm(d) < 1e-9) d = c[3] - c[0];
  return norm(d) < 1e-9 ? Vec2{0, 0} : unit(d);
}

struct Sample {
  Vec2 x;
  Vec2 direction;
};

/// Fits one smooth stretch.
class Fitter {
 public:
  Fitter(std::vector<Sample> samples, double tolerance, std::vector<Curve>& out)
      : samples_(std::move(samples)), tolerance_(tolerance), out_(out) {}

  void run() { fit(0, samples_.size() - 1); }

 private:
  void fit(std::size_t first, std::size_t last) {
    const Vec2 a = samples_[first].x;
    const Vec2 b = samples_[last].x;
    double worst = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      worst = std::max(worst, distance_to_segment(samples_[i].x, a, b));
    }
    if (worst <= tolerance_) {
      out_.push_back(straight(a, b));
      return;
    }
    set_parameters(first, last);
    std::size_t split = (first + last) / 2;
    for (int round = 0; round <= kCorrections; ++round) {
      const Curve curve = best(first, last);
      double error = 0;
      for (std::size_t i = first + 1; i < last; ++i) {
        const double e = norm(at(curve, parameter_[i - first]) - samples_[i].x);
        if (e > error) {
          error = e;
          split = i;
        }
      }
      if (error <= tolerance_) {
        out_.push_back(curve);
        return;
      }
      if (error > 4 * tolerance_) break;
      correct_parameters(curve, first, last);
    }
    fit(first, split);
    fit(split, last);
  }

  void set_parameters(std::size_t first, std::size_t last) {
    parameter_.assign(last - first + 1, 0);
    for (std::size_t i = first + 1; i <= last; ++i) {
      parameter_[i - first] = parameter_[i - first - 1] + norm(samples_[i].x - samples_[i - 1].x);
    }
    const double length = parameter_.back();
    for (double& t : parameter_) t /= length;
  }

  /// A step of Newton's method towards the nearest points on the curve.
  void correct_parameters(const Curve& curve, std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i) {
      double& t = parameter_[i - first];
      const Vec2 off = at(curve, t) - samples_[i].x;
      const Vec2 d = derivative(curve, t);
      const double slope = dot(d, d) + dot(off, second_derivative(curve, t));
      if (slope > 1e-12) t = std::clamp(t - dot(off, d) / slope, 0.0, 1.0);
    }
  }

  /// Least squares for the lengths of both arms, along the given directions.
  Curve best(std::size_t first, std::size_t last) const {
    const Vec2 a = samples_[first].x;
    const Vec2 b = samples_[last].x;
    const Vec2 from = samples_[first].direction;
    const Vec2 to = -1 * samples_[last].direction;
    double c00 = 0, c01 = 0, c11 = 0, x0 = 0, x1 = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double t = parameter_[i - first];
      const double s = 1 - t;
      const Vec2 p = (3 * s * s * t) * from;
      const Vec2 q = (3 * s * t * t) * to;
      const Vec2 rest = samples_[i].x - ((s * s * s + 3 * s * s * t) * a + (t * t * t + 3 * s * t * t) * b);
      c00 += dot(p, p);
      c01 += dot(p, q);
      c11 += dot(q, q);
      x0 += dot(p, rest);
      x1 += dot(q, rest);
    }
    const double chord = norm(b - a);
    const double determinant = c00 * c11 - c01 * c01;
    double l0 = chord / 3;
    double l1 = chord / 3;
    if (determinant > 1e-12 * c00 * c11) {
      l0 = (x0 * c11 - x1 * c01) / determinant;
      l1 = (c00 * x1 - c01 * x0) / determinant;
      if (!(l0 > 0.01 * chord) || !(l1 > 0.01 * chord) || l0 > 4 * chord || l1 > 4 * chord) {
        l0 = l1 = chord / 3;
      }
    }
    return {a, a + l0 * from, b + l1 * to, b};
  }

  std::vector<Sample> samples_;
  std::vector<double> parameter_;
  double tolerance_;
  std::vector<Curve>& out_;
};

void simplify_lines(std::span<const Curve> chain, double tolerance, std::vector<Curve>& out) {
  const Vec2 a = chain.front()[0];
  const Vec2 b = chain.back()[3];
  double worst = 0;
  std::size_t split = 0;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const double d = distance_to_segment(chain[i][3], a, b);
    if (d > worst) {
      worst = d;
      split = i + 1;
    }
  }
  if (worst <= tolerance) {
    out.push_back(straight(a, b));
    return;
  }
  simplify_lines(chain.first(split), tolerance, out);
  simplify_lines(chain.subspan(split), tolerance, out);
}

void fit_smooth(std::span<const Curve> chain, double tolerance, std::vector<Curve>& out) {
  std::vector<Sample> samples{{chain.front()[0], direction(chain.front(), 0)}};
  for (std::size_t k = 0; k < chain.size(); ++k) {
    for (int i = 1; i <= kSamples; ++i) {
      const double t = double(i) / kSamples;
      Vec2 d = direction(chain[k], t);
      if (i == kSamples && k + 1 < chain.size()) {
        const Vec2 mean = d + direction(chain[k + 1], 0);
        if (norm(mean) > 1e-9) d = unit(mean);
      }
      const Vec2 x = at(chain[k], t);
      if (norm(x - samples.back().x) > 1e-9) samples.push_back({x, d});
    }
  }
  if (samples.size() < 2) return;
  const std::size_t before = out.size();
  Fitter(std::move(samples), tolerance, out).run();
  // Never more than there were.
  if (out.size() - before > chain.size()) {
    out.resize(before);
    out.insert(out.end(), chain.begin(), chain.end());
  }
}

bool is_corner(const Curve& before, const Curve& after) {
  const Vec2 a = direction(before, 1);
  const Vec2 b = direction(after, 0);
  return dot(a, b) < std::cos(kCorner);
}

}  // namespace

std::vector<Curve> simplified(const std::vector<Curve>& chain, double tolerance) {
  std::vector<Curve> out;
  for (std::size_t begin = 0; begin < chain.size();) {
    const bool lines = is_straight(chain[begin]);
    std::size_t end = begin + 1;
    while (end < chain.size() && end - begin < kLongest && is_straight(chain[end]) == lines &&
           (lines || !is_corner(chain[end - 1], chain[end]))) {
      ++end;
    }
    const auto stretch = std::span(chain).subspan(begin, end - begin);
    if (lines) {
      simplify_lines(stretch, tolerance, out);
    } else {
      fit_smooth(stretch, tolerance, out);
    }
    begin = end;
  }
  return out;
}

}  // namespace knotreel::exporting
