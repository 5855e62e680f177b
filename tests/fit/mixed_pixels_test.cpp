// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/mixed_pixels.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>

#include "fit/fit_cases.h"
#include "fit/mixed_equations.h"
#include "knotreel/fit/colour_fit.h"
#include "support/pictures.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;

/// One to four places all over the domain per pixel, with random shares and weights, and the mean of the
/// colours of a surface there.
MixedPixels mixed_of(const spline::Basis& basis, std::span<const double> control, std::size_t channels,
                     std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.01, 1);
  MixedPixels mixed;
  mixed.begin.push_back(0);
  std::vector<spline::BasisValue> values;
  for (std::size_t i = 0; i < count; ++i) {
    mixed.pixels.push_back(static_cast<std::uint32_t>(i));
    mixed.weights.push_back(unit(random));
    const std::size_t places = 1 + random() % 4;
    double sum = 0;
    std::vector<double> colour(channels, 0);
    for (std::size_t k = 0; k < places; ++k) {
      mixed.places.push_back({48 * unit(random), 40 * unit(random)});
      mixed.shares.push_back(unit(random));
      sum += mixed.shares.back();
    }
    for (std::size_t k = mixed.begin.back(); k < mixed.places.size(); ++k) {
      mixed.shares[k] /= sum;
      basis.evaluate(mixed.places[k], values);
      for (const auto& v : values) {
        for (std::size_t c = 0; c < channels; ++c)
          colour[c] += mixed.shares[k] * v.value * control[v.function * channels + c];
      }
    }
    for (const double c : colour) mixed.colours.push_back(static_cast<float>(c));
    mixed.begin.push_back(mixed.places.size());
  }
  return mixed;
}

TEST(MixedPixels, AddTheRowsOfTheirMeans) {
  const auto space = make_space(featured_mesh(1), 2);
  const spline::Basis basis(space);
  const std::size_t n = space->function_count();
  const std::vector<double> control = random_control(3 * n, 3);
  MixedPixels mixed = mixed_of(basis, random_control(3 * n, 4), 3, 300, 5);
  for (const bool all : {true, false}) {
    std::vector<std::uint8_t> fixed;
    for (std::size_t f = 0; f < n && !all; ++f) fixed.push_back(f % 3 == 0 ? 1 : 0);
    const Sought sought(n, fixed, control);
    const auto unknowns = static_cast<Eigen::Index>(sought.functions.size());
    NormalEquations normal;
    normal.matrix.resize(unknowns, unknowns);
    normal.matrix.setIdentity();
    normal.right.setOnes(unknowns, 3);
    const NormalEquations equations = mixed_equations(basis, mixed, sought, 3);
    normal.matrix += equations.matrix;
    normal.right += equations.right;

    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(unknowns, unknowns);
    Eigen::MatrixXd right = Eigen::MatrixXd::Ones(unknowns, 3);
    std::vector<spline::BasisValue> values;
    for (std::size_t i = 0; i < mixed.pixels.size(); ++i) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
      for (std::size_t k = mixed.begin[i]; k < mixed.begin[i + 1]; ++k) {
        basis.evaluate(mixed.places[k], values);
        for (const auto& v : values) row[static_cast<Eigen::Index>(v.function)] += mixed.shares[k] * v.value;
      }
      Eigen::RowVector3d colour;
      Eigen::VectorXd of_sought(unknowns);
      for (Eigen::Index c = 0; c < 3; ++c)
        colour[c] = static_cast<double>(mixed.colours[3 * i + std::size_t(c)]);
      for (std::size_t f = 0; f < n; ++f) {
        const double value = row[static_cast<Eigen::Index>(f)];
        if (sought.has(static_cast<spline::FunctionIndex>(f))) {
          of_sought[sought.number_of[f]] = value;
        } else {
          for (Eigen::Index c = 0; c < 3; ++c) colour[c] -= value * control[3 * f + std::size_t(c)];
        }
      }
      matrix += mixed.weights[i] * of_sought * of_sought.transpose();
      right += mixed.weights[i] * of_sought * colour;
    }
    const Eigen::MatrixXd lower = matrix.triangularView<Eigen::Lower>();
    EXPECT_LT((Eigen::MatrixXd(normal.matrix) - lower).cwiseAbs().maxCoeff(), 1e-9) << all;
    EXPECT_LT((normal.right - right).cwiseAbs().maxCoeff(), 1e-6) << all;
  }
}

TEST(MixedPixels, TellWhatNoOtherPixelDoes) {
  const auto space = make_space(featured_mesh(1), 2);
  const spline::Basis basis(space);
  const std::vector<double> control = random_control(space->function_count(), 6);
  const std::vector<float> none(48 * 40, 0);
  const MixedPixels mixed = mixed_of(basis, control, 1, 4000, 7);
  const image::Image black = image::make_image(48, 40, 1);
  const ColourFit fit = fit_colours(basis, {.image = &black, .weights = none, .mixed = &mixed},
                                    {.ridge = 1e-11, .smooth_corners = false, .find_residual = false});
  const std::vector<double> expected = slow_surface(basis, control, 1, 48, 40, {});
  const std::vector<double> found = slow_surface(basis, fit.control, 1, 48, 40, {});
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(found[i], expected[i], 0.1) << i;
}

}  // namespace
}  // namespace knotreel::fit
