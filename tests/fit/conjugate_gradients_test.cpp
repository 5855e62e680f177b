// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/conjugate_gradients.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <limits>
#include <random>

#include "fit/reduced_system.h"
#include "knotreel/base/error.h"
#include "support/dense.h"

namespace knotreel::fit {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

constexpr std::uint64_t kConjugateGradientsSeed = 20261123;

/// The lower half of sum_k w_k v_k v_k^T for vectors of three positive entries at unknowns close to each
/// other, as normal equations of basis functions are.
Matrix normal_equations(int n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> weight(0.05, 1);
  std::uniform_int_distribution<int> unknown(0, n - 1);
  std::uniform_int_distribution<int> step(1, 30);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1e-3);
  for (int k = 0; k < 12 * n; ++k) {
    const int first = unknown(random);
    const int at[3] = {first, (first + step(random)) % n, (first + 40) % n};
    const double v[3] = {weight(random), weight(random), weight(random)};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        if (at[a] >= at[b]) entries.emplace_back(at[a], at[b], v[a] * v[b]);
      }
    }
  }
  Matrix lower(n, n);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

Eigen::MatrixXd random_numbers(int rows, int columns, double reach, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-reach, reach);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return number(random); });
}

TEST(ConjugateGradients, FindTheSolutionFromNearby) {
  std::mt19937_64 random(kConjugateGradientsSeed);
  for (const int n : {1, 2, 45, 600}) {
    for (int columns = 1; columns <= 4; ++columns) {
      const Matrix lower = normal_equations(n, random);
      const Eigen::MatrixXd solution = random_numbers(n, columns, 255, random);
      const Eigen::MatrixXd right = lower.selfadjointView<Eigen::Lower>() * solution;
      const Eigen::MatrixXd start = solution + random_numbers(n, columns, 3, random);
      const auto found = conjugate_gradients(lower, right, start);
      ASSERT_TRUE(found) << n;
      EXPECT_LT((*found - solution).cwiseAbs().maxCoeff(), 0.05) << n << ' ' << columns;
      const auto finer = conjugate_gradients(lower, right, start, {.tolerance = 1e-8, .most_steps = 100});
      ASSERT_TRUE(finer) << n;
      EXPECT_LT((*finer - solution).cwiseAbs().maxCoeff(), 1e-6) << n << ' ' << columns;
    }
  }
}

TEST(ConjugateGradients, FindTheSolutionWhereTheFactorNeedsALargerDiagonal) {
  // As Kershaw's example, positive definite, but a factor without fill has a negative pivot, unless a tenth
  // is added to the diagonal.
  Eigen::Matrix4d dense;
  dense << 3, -1.8, 0, 1.8, -1.8, 3, -1.8, 0, 0, -1.8, 3, -1.8, 1.8, 0, -1.8, 3;
  const Matrix lower = Matrix(dense.sparseView()).triangularView<Eigen::Lower>();
  std::mt19937_64 random(kConjugateGradientsSeed);
  const Eigen::MatrixXd solution = random_numbers(4, 3, 255, random);
  const auto found =
      conjugate_gradients(lower, testing::product(dense, solution), Eigen::MatrixXd::Zero(4, 3));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - solution).cwiseAbs().maxCoeff(), 0.1);
}

TEST(ConjugateGradients, StayWhereTheSolutionIs) {
  std::mt19937_64 random(kConjugateGradientsSeed);
  const Matrix lower = normal_equations(200, random);
  const Eigen::MatrixXd solution = random_numbers(200, 3, 255, random);
  const Eigen::MatrixXd right = lower.selfadjointView<Eigen::Lower>() * solution;
  const auto found = conjugate_gradients(lower, right, solution, {.most_steps = 0});
  ASSERT_TRUE(found);
  EXPECT_LT((*found - solution).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ConjugateGradients, SayWhenTheyDoNotArrive) {
  std::mt19937_64 random(kConjugateGradientsSeed);
  const Matrix lower = normal_equations(200, random);
  const Eigen::MatrixXd right = random_numbers(200, 3, 255, random);
  const Eigen::MatrixXd far = random_numbers(200, 3, 1e60, random);
  EXPECT_FALSE(conjugate_gradients(lower, right, far));
  Eigen::MatrixXd none = far;
  none(17, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(conjugate_gradients(lower, right, none));
  Matrix indefinite = lower;
  for (int i = 0; i < 200; i += 3) indefinite.coeffRef(i, i) *= -1;
  EXPECT_FALSE(conjugate_gradients(indefinite, right, 0 * far));
  EXPECT_THROW(conjugate_gradients(lower, right, random_numbers(199, 3, 1, random)), Error);
}

/// What is not given up goes the same way.
TEST(ConjugateGradients, MayBeGivenUpHalfway) {
  std::mt19937_64 random(kConjugateGradientsSeed);
  const Matrix lower = normal_equations(600, random);
  const Eigen::MatrixXd right = random_numbers(600, 3, 255, random);
  const Eigen::MatrixXd start = random_numbers(600, 3, 255, random);
  const GradientOptions patient{.tolerance = 1e-6, .most_steps = 100};
  const auto found = conjugate_gradients(lower, right, start, patient);
  ASSERT_TRUE(found);
  int steps = 1;
  while (!conjugate_gradients(lower, right, start, {.tolerance = 1e-6, .most_steps = steps})) ++steps;
  for (const double most : {1e-5, 1e-3, 1e9}) {
    GradientOptions options = patient;
    options.most_steps = 2 * (steps / 2 + 1);
    options.most_at_half = most;
    const auto same = conjugate_gradients(lower, right, start, options);
    EXPECT_EQ(same.has_value(), most > 1);
    if (same) {
      EXPECT_EQ(*same, *found);
    }
    options.most_steps = 2 * (steps + 1);
    EXPECT_TRUE(conjugate_gradients(lower, right, start, options)) << "it is there before half of the steps";
  }
}

TEST(SolveReduced, ComesToTheSameFromAnyStart) {
  std::mt19937_64 random(kConjugateGradientsSeed);
  const int n = 300;
  const Matrix lower = normal_equations(n, random);
  // Every tenth unknown is the mean of its neighbours.
  Matrix p(n, n - n / 10);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    const int column = i - i / 10 - 1;
    if (i % 10 == 0) {
      if (column >= 0) entries.emplace_back(i, column, 0.5);
      entries.emplace_back(i, column + 1, column >= 0 ? 0.5 : 1.0);
    } else {
      entries.emplace_back(i, column, 1.0);
    }
  }
  p.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd right = random_numbers(n, 3, 255, random);
  const Eigen::MatrixXd direct = solve_reduced(lower, p, right);
  const Eigen::MatrixXd near = direct + random_numbers(n, 3, 2, random);
  const Eigen::MatrixXd found = solve_reduced(lower, p, right, near);
  EXPECT_LT((found - direct).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_GT((found - direct).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(solve_reduced(lower, p, right, random_numbers(n, 3, 1e60, random)), direct);
}

}  // namespace
}  // namespace knotreel::fit
