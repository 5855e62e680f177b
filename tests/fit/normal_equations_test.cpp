// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/normal_equations.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>

#include "fit/fit_cases.h"
#include "knotreel/base/parallel.h"
#include "support/pictures.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;
using spline::PixelValues;

/// A^T W A and A^T W b, from the values at each pixel.
struct Reference {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd right;
};

Reference reference(const spline::Basis& basis, const image::Image& target, std::span<const Vec2> places,
                    std::span<const float> weights, std::span<const std::uint8_t> active) {
  const auto pixels = static_cast<Eigen::Index>(target.pixel_count());
  const auto functions = static_cast<Eigen::Index>(basis.space().function_count());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd b(pixels, target.channels);
  Eigen::VectorXd w = Eigen::VectorXd::Ones(pixels);
  std::vector<spline::BasisValue> values;
  for (Eigen::Index i = 0; i < pixels; ++i) {
    const auto pixel = static_cast<std::size_t>(i);
    basis.evaluate(places.empty() ? pixel_centre(pixel, target.width) : places[pixel], values);
    for (const auto& v : values) {
      if (active.empty() || active[v.function])
        entries.emplace_back(i, static_cast<Eigen::Index>(v.function), v.value);
    }
    for (int c = 0; c < target.channels; ++c)
      b(i, c) = static_cast<double>(target.samples[pixel * std::size_t(target.channels) + std::size_t(c)]);
    if (!weights.empty()) w(i) = static_cast<double>(weights[pixel]);
  }
  Eigen::SparseMatrix<double> a(pixels, functions);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> weighted = w.asDiagonal() * a;
  return {Eigen::MatrixXd(weighted.transpose() * a), weighted.transpose() * b};
}

void expect_equal(const NormalEquations& fast, const Reference& slow, const std::string& name) {
  const Eigen::MatrixXd matrix(fast.matrix);
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (Eigen::Index r = c; r < matrix.rows(); ++r)
      ASSERT_NEAR(matrix(r, c), slow.matrix(r, c), 1e-8) << name << ", " << r << ", " << c;
  }
  ASSERT_LT((fast.right - slow.right).cwiseAbs().maxCoeff(), 1e-5) << name;
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    ASSERT_EQ(fast.matrix.innerIndexPtr()[fast.matrix.outerIndexPtr()[c]], c) << name << ": no diagonal";
  }
}

TEST(NormalEquations, EqualDenseOnes) {
  std::mt19937_64 random(41);
  for (const auto& c : knotreel::testing::fewer_if_checked(random_cases(41, 24))) {
    for (const int degree : {1, 2, 3}) {
      const spline::Basis basis(make_space(c.mesh, degree));
      const int width = static_cast<int>(c.mesh.width);
      const int height = static_cast<int>(c.mesh.height);
      const image::Image target = test::random_picture(width, height, 1 + static_cast<int>(random() % 4), 5);
      const auto pixels = static_cast<std::size_t>(target.pixel_count());
      std::vector<Vec2> places;
      std::vector<float> weights;
      std::vector<std::uint8_t> active;
      if (random() % 2) places = scattered_places(width, height, 1.2, random());
      if (random() % 2) weights = random_weights(pixels, random());
      if (random() % 2) {
        for (std::size_t f = 0; f < basis.space().function_count(); ++f) active.push_back(random() % 3 > 0);
      }
      const PixelValues values(basis, width, height, places, active);
      const NormalEquations fast = assemble<double>(values, target, weights);
      expect_equal(fast, reference(basis, target, places, weights, active), c.name);

      const ThreadCap one(1);
      const NormalEquations alone = assemble<double>(values, target, weights);
      ASSERT_TRUE(alone.right == fast.right) << c.name;
      ASSERT_EQ(alone.matrix.nonZeros(), fast.matrix.nonZeros()) << c.name;
      ASSERT_TRUE(Eigen::MatrixXd(alone.matrix) == Eigen::MatrixXd(fast.matrix)) << c.name;

      const NormalEquations single = assemble<float>(values, target, weights);
      const Eigen::MatrixXd change = Eigen::MatrixXd(single.matrix) - Eigen::MatrixXd(fast.matrix);
      ASSERT_LE(change.cwiseAbs().maxCoeff(), 1e-5 * fast.matrix.diagonal().maxCoeff()) << c.name;
      ASSERT_LE((single.right - fast.right).cwiseAbs().maxCoeff(), 1e-5 * fast.right.cwiseAbs().maxCoeff())
          << c.name;
    }
  }
}

/// Those of the sought functions alone, for what the others leave of the target.
TEST(NormalEquations, OfSomeControlPointsEqualDenseOnes) {
  std::mt19937_64 random(43);
  for (const auto& c : random_cases(43, 12)) {
    const spline::Basis basis(make_space(c.mesh, 2));
    const int width = static_cast<int>(c.mesh.width);
    const int height = static_cast<int>(c.mesh.height);
    const image::Image target = test::random_picture(width, height, 3, 6);
    const std::vector<float> weights = random_weights(static_cast<std::size_t>(target.pixel_count()), 2);
    const std::size_t count = basis.space().function_count();
    const std::vector<double> control = random_control(3 * count, 4);
    std::vector<std::uint8_t> fixed;
    for (std::size_t f = 0; f < count; ++f) fixed.push_back(random() % 3 > 0);
    const Sought sought(count, fixed, control);

    const Reference all = reference(basis, target, {}, weights, {});
    const auto n = static_cast<Eigen::Index>(sought.functions.size());
    Reference some{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, 3)};
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto f = static_cast<Eigen::Index>(sought.functions[std::size_t(i)]);
      for (Eigen::Index j = 0; j < n; ++j)
        some.matrix(i, j) = all.matrix(f, static_cast<Eigen::Index>(sought.functions[std::size_t(j)]));
      some.right.row(i) = all.right.row(f);
      for (std::size_t g = 0; g < count; ++g) {
        if (!fixed[g]) continue;
        for (Eigen::Index k = 0; k < 3; ++k)
          some.right(i, k) -= all.matrix(f, static_cast<Eigen::Index>(g)) * control[3 * g + std::size_t(k)];
      }
    }
    const PixelValues values(basis, width, height, {}, {});
    expect_equal(assemble<double>(values, target, weights, sought), some, c.name);
  }
}

}  // namespace
}  // namespace knotreel::fit
