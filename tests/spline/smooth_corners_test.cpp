// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/smooth_corners.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <set>

#include "spline/law_cases.h"
#include "support/dense.h"

/// What becomes of functions that two multiple corners share; smoothness itself is in continuity_test.cpp.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kSmoothCornersSeed = 20260606;

bool is_shared(const SplineSpace& space, FunctionIndex f) {
  std::set<CornerIndex> corners;
  for (const CornerIndex c : space.functions()[f].knots) {
    if (c != kNoCorner && space.cut().corners[c].multiple) corners.insert(c);
  }
  return corners.size() > 1;
}

class SmoothCorners : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, SmoothCorners, ::testing::Values(1, 2, 3));

TEST_P(SmoothCorners, ColumnsAreOrthonormal) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSmoothCornersSeed, 20)) {
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    for (const SharedFunctions shared : {SharedFunctions::kFree, SharedFunctions::kTied}) {
      const Eigen::SparseMatrix<double> p = smooth_corner_prolongation(space, shared);
      const Eigen::MatrixXd product = Eigen::MatrixXd(p.transpose() * p);
      EXPECT_LE((product - Eigen::MatrixXd::Identity(p.cols(), p.cols())).cwiseAbs().maxCoeff(), 1e-10);
      // Constants are smooth.
      const Eigen::VectorXd one = Eigen::VectorXd::Ones(p.rows());
      EXPECT_LE((p * (p.transpose() * one) - one).cwiseAbs().maxCoeff(), 1e-9) << c.to_text();
    }
  }
}

TEST_P(SmoothCorners, SharedFunctionsAreFreeOfBothCorners) {
  std::size_t seen = 0;
  for (const MeshCase& c : knotreel::testing::law_cases(kSmoothCornersSeed, 20)) {
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    const Eigen::SparseMatrix<double> p = smooth_corner_prolongation(space, SharedFunctions::kFree);
    const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = p;
    for (FunctionIndex f = 0; f < space.function_count(); ++f) {
      if (!is_shared(space, f)) continue;
      ++seen;
      int entries = 0;
      for (decltype(rows)::InnerIterator it(rows, static_cast<Eigen::Index>(f)); it; ++it) {
        ++entries;
        EXPECT_EQ(it.value(), 1);
        EXPECT_EQ(p.col(it.col()).nonZeros(), 1);
      }
      EXPECT_EQ(entries, 1);
    }
  }
  if (GetParam() > 1) {
    EXPECT_GT(seen, 10u);
  }
}

TEST_P(SmoothCorners, WithoutSharedFunctionsBothAreTheSame) {
  std::size_t seen = 0;
  for (const MeshCase& c : knotreel::testing::law_cases(kSmoothCornersSeed, 20)) {
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    bool any = false;
    for (FunctionIndex f = 0; f < space.function_count(); ++f) any = any || is_shared(space, f);
    const Eigen::MatrixXd tied(smooth_corner_prolongation(space, SharedFunctions::kTied));
    const Eigen::MatrixXd free(smooth_corner_prolongation(space, SharedFunctions::kFree));
    if (any) {
      EXPECT_GT(free.cols(), 0);
      // Whatever obeys all corners obeys those that are left.
      EXPECT_LE((knotreel::testing::product(free, knotreel::testing::product(free.transpose(), tied)) - tied)
                    .cwiseAbs()
                    .maxCoeff(),
                1e-9)
          << c.to_text();
      continue;
    }
    ++seen;
    ASSERT_EQ(tied.cols(), free.cols());
    EXPECT_EQ(tied, free);
  }
  EXPECT_GT(seen, 0u);
}

}  // namespace
}  // namespace knotreel::spline
