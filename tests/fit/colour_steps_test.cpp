// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/colour_steps.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "knotreel/base/error.h"
#include "support/dense.h"

namespace knotreel::fit {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::uint64_t kColourStepsSeed = 20261124;
constexpr double kColourStep = 3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The normal equations of B-splines of degree 2 with three pixels to a knot, and some noise.
struct System {
  Matrix lower;
  Eigen::MatrixXd right;
  RowMajor solution;
};

System quadratic_splines(int n, int channels, std::mt19937_64& random) {
  std::uniform_real_distribution<double> level(0, 255);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, n);
  for (int i = 0; i < 3 * n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double t = std::abs((i + 0.5) / 3 - (j + 0.5));
      if (t < 0.5) a(i, j) = 0.75 - t * t;
      if (t >= 0.5 && t < 1.5) a(i, j) = 0.5 * (1.5 - t) * (1.5 - t);
    }
  }
  const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(3 * n, channels, [&] { return level(random); });
  const Eigen::MatrixXd matrix = testing::product(a.transpose(), a);
  const Eigen::MatrixXd right = testing::product(a.transpose(), b);
  return {Eigen::MatrixXd(matrix.triangularView<Eigen::Lower>()).sparseView(), right,
          testing::least_squares(a, b)};
}

std::vector<double> numbers(const RowMajor& m) {
  return {m.data(), m.data() + m.size()};
}

/// Where control points would rather be: red and blue as far from where they were as green is.
std::vector<double> references(const std::vector<double>& control, const std::vector<double>& before,
                               std::size_t channels) {
  std::vector<double> result = before;
  for (double& b : result) b = std::round(b / kColourStep) * kColourStep;
  for (std::size_t i = 0; channels >= 3 && i < result.size(); i += channels) {
    if (std::isnan(result[i + 1])) continue;
    const double lead = control[i + 1] - result[i + 1];
    result[i] += lead;
    result[i + 2] += lead;
  }
  return result;
}

/// What descend_in_steps() makes small, of all channels.
/// @param reference NaN: none. Or empty.
double objective(const System& s, const std::vector<double>& control, const std::vector<double>& reference,
                 double reluctance) {
  const Eigen::Map<const RowMajor> c(control.data(), s.right.rows(), s.right.cols());
  const Eigen::MatrixXd ac = s.lower.selfadjointView<Eigen::Lower>() * Eigen::MatrixXd(c);
  const double least = ColourSteps{}.least_weight * s.lower.diagonal().mean();
  double sum = (c.array() * (ac - 2 * s.right).array()).sum();
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (std::isnan(reference[i])) continue;
    const auto row = static_cast<Eigen::Index>(i) / s.right.cols();
    const bool leads = s.right.cols() >= 3 && static_cast<Eigen::Index>(i) % s.right.cols() == 1;
    sum += (leads ? 4.0 / 3 : 1.0) * reluctance * kColourStep * std::max(least, s.lower.coeff(row, row)) *
           std::abs(control[i] - reference[i]);
  }
  return sum;
}

std::vector<double> rounded(std::vector<double> control) {
  for (double& c : control) c = std::round(c / kColourStep) * kColourStep;
  return control;
}

TEST(ColourSteps, AreMultiplesThatNoOtherOneNextToThemBeats) {
  std::mt19937_64 random(kColourStepsSeed);
  std::uniform_real_distribution<double> change(-12, 12);
  for (const double reluctance : {0.0, 0.4, 1.5}) {
    for (int channels = 1; channels <= 4; ++channels) {
      const System s = quadratic_splines(40, channels, random);
      std::vector<double> before = numbers(s.solution);
      for (double& b : before) b = change(random) < -8 ? kNone : b + change(random);
      std::vector<double> control = numbers(s.solution);
      const std::vector<std::uint8_t> moving(40, 1);
      // Sweeps are few; from where the last call ended they go on.
      for (int k = 0; k < 5; ++k)
        descend_in_steps(s.lower, s.right, moving, before, {kColourStep, std::vector<double>(40, reluctance)},
                         control);
      const std::vector<double> reference = references(control, before, static_cast<std::size_t>(channels));
      const double least = objective(s, control, reference, reluctance);
      EXPECT_LT(least, objective(s, rounded(numbers(s.solution)), reference, reluctance));
      for (std::size_t i = 0; i < control.size(); ++i) {
        EXPECT_EQ(control[i], std::round(control[i] / kColourStep) * kColourStep);
        for (const double step : {-kColourStep, kColourStep}) {
          std::vector<double> other = control;
          other[i] += step;
          EXPECT_GT(objective(s, other, reference, reluctance), least - 1e-6) << i << ' ' << reluctance;
        }
      }
    }
  }
}

TEST(ColourSteps, LoseLessThanRoundingEachByItself) {
  std::mt19937_64 random(kColourStepsSeed);
  const System s = quadratic_splines(400, 3, random);
  std::vector<double> control = numbers(s.solution);
  descend_in_steps(s.lower, s.right, std::vector<std::uint8_t>(400, 1), {}, {kColourStep}, control);
  const double best = objective(s, numbers(s.solution), {}, 0);
  const double by_itself = objective(s, rounded(numbers(s.solution)), {}, 0) - best;
  EXPECT_LT(objective(s, control, {}, 0) - best, 0.9 * by_itself);
}

TEST(ColourSteps, StayForChangesThatAreNotWorthIt) {
  std::mt19937_64 random(kColourStepsSeed);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  const System s = quadratic_splines(200, 3, random);
  const std::vector<double> before = rounded(numbers(s.solution));
  const RowMajor old = Eigen::Map<const RowMajor>(before.data(), 200, 3);
  // The best control points are those of before but for a little noise, and for one that is far off.
  RowMajor wanted = old + RowMajor::NullaryExpr(200, 3, [&] { return noise(random); });
  wanted(100, 1) += 30;
  const Eigen::MatrixXd right = s.lower.selfadjointView<Eigen::Lower>() * Eigen::MatrixXd(wanted);
  std::vector<double> control = numbers(wanted);
  descend_in_steps(s.lower, right, std::vector<std::uint8_t>(200, 1), before,
                   {kColourStep, std::vector<double>(200, 0.4)}, control);
  for (std::size_t i = 0; i < control.size(); ++i) {
    if (i == 301) {
      EXPECT_EQ(control[i], before[i] + 30);
    } else {
      EXPECT_EQ(control[i], before[i]) << i;
    }
  }
}

/// Red and blue would not be worth a step each by themselves.
TEST(ColourSteps, RedAndBlueGoWhereGreenGoes) {
  constexpr double kReluctance = 1.5;
  const Eigen::MatrixXd diagonal = Eigen::MatrixXd::Identity(2, 2);
  for (const double green : {0.0, 4 * kColourStep}) {
    RowMajor wanted(2, 4);
    wanted << 60 + 1.2 * kColourStep, 90 + green, 120 + 1.2 * kColourStep, 30 + 1.2 * kColourStep, 60, 90,
        120, 30;
    const std::vector<double> before{60, 90, 120, 30, 60, 90, 120, 30};
    std::vector<double> control = numbers(wanted);
    descend_in_steps(diagonal.sparseView(), testing::product(diagonal, wanted),
                     std::vector<std::uint8_t>(2, 1), before,
                     {kColourStep, std::vector<double>(2, kReluctance)}, control);
    // Of four steps one is the price of leaving, of those of the others 0.75.
    const double lead = green == 0 ? 0 : 3 * kColourStep;
    const double others = green == 0 ? 0 : 2 * kColourStep;
    EXPECT_EQ(control, (std::vector<double>{60 + others, 90 + lead, 120 + others, 30, 60, 90, 120, 30}))
        << green;
  }
}

TEST(ColourSteps, StayLongerWhereFewPixelsSpeakForThem) {
  Eigen::MatrixXd diagonal = Eigen::MatrixXd::Identity(10, 10);
  diagonal(4, 4) = 0.01;
  const System s{
      diagonal.sparseView(), testing::product(diagonal, Eigen::MatrixXd::Constant(10, 1, 100)), {}};
  const std::vector<double> before(10, 99 - 3 * kColourStep);
  std::vector<double> control(10, 100);
  descend_in_steps(s.lower, s.right, std::vector<std::uint8_t>(10, 1), before,
                   {kColourStep, std::vector<double>(10, 0.4)}, control);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(control[i], i == 4 ? before[i] : 99) << i;
}

TEST(ColourSteps, OnlyRoundWhatShallNotMove) {
  std::mt19937_64 random(kColourStepsSeed);
  const System s = quadratic_splines(100, 3, random);
  std::vector<std::uint8_t> moving(100, 1);
  for (std::size_t i = 0; i < 100; i += 3) moving[i] = 0;
  std::vector<double> control = numbers(s.solution);
  descend_in_steps(s.lower, s.right, moving, {}, {kColourStep}, control);
  const std::vector<double> alone = rounded(numbers(s.solution));
  std::size_t moved = 0;
  for (std::size_t i = 0; i < control.size(); ++i) {
    moved += control[i] != alone[i];
    if (!moving[i / 3]) {
      EXPECT_EQ(control[i], alone[i]);
    }
  }
  EXPECT_GT(moved, 10u);
}

TEST(ColourSteps, NeedOneOfEverything) {
  std::mt19937_64 random(kColourStepsSeed);
  const System s = quadratic_splines(10, 3, random);
  std::vector<double> control(30);
  const std::vector<std::uint8_t> few(9, 1);
  EXPECT_THROW(descend_in_steps(s.lower, s.right, few, {}, {kColourStep}, control), Error);
  const std::vector<std::uint8_t> moving(10, 1);
  EXPECT_THROW(descend_in_steps(s.lower, s.right, moving, std::vector<double>(29), {kColourStep}, control),
               Error);
  EXPECT_THROW(
      descend_in_steps(s.lower, s.right, moving, {}, {kColourStep, std::vector<double>(9, 0.4)}, control),
      Error);
  control.pop_back();
  EXPECT_THROW(descend_in_steps(s.lower, s.right, moving, {}, {kColourStep}, control), Error);
}

}  // namespace
}  // namespace knotreel::fit
