// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/spline/basis.h"
#include "spline/law_cases.h"

/// Laws of TCB-splines over the corpus and 200 random meshes, degrees 1, 2 and 3.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kLawsSeed = 20260101;

const std::vector<MeshCase>& all_cases() {
  static const std::vector<MeshCase> cases = knotreel::testing::law_cases(kLawsSeed, 200);
  return cases;
}

class SplineLaws : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, SplineLaws, ::testing::Values(1, 2, 3));

std::shared_ptr<const SplineSpace> make_space(const MeshCase& c, int degree) {
  return std::make_shared<const SplineSpace>(c.mesh, degree);
}

TEST_P(SplineLaws, FunctionsSumToOneOnTheClosedDomain) {
  for (const MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const Basis basis(make_space(c, GetParam()));
    std::vector<BasisValue> values;
    double worst = 0;
    double lowest = 0;
    Vec2 worst_at;
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kLawsSeed, 200)) {
      basis.evaluate(u, values);
      double sum = 0;
      for (const BasisValue& v : values) {
        sum += v.value;
        lowest = std::min(lowest, v.value);
      }
      if (!(std::abs(sum - 1) <= worst)) {
        worst = std::abs(sum - 1);
        worst_at = u;
      }
    }
    EXPECT_LE(worst, 1e-9) << "at " << worst_at.x << ' ' << worst_at.y << '\n' << c.to_text();
    EXPECT_GE(lowest, -1e-12) << c.to_text();
  }
}

TEST_P(SplineLaws, ProductEvaluationEqualsTheRecurrence) {
  for (const MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const auto space = make_space(c, GetParam());
    const Basis basis(space);
    const ReferenceBasis reference(*space);
    std::vector<Vec2> points = knotreel::testing::probe_points(c.mesh, kLawsSeed, 30);
    // The reference is slow: a stride through the probes, with all their kinds.
    double worst = 0;
    Vec2 worst_at;
    std::vector<BasisValue> values;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 60) {
      basis.evaluate(points[i], values);
      std::vector<double> dense(space->function_count(), 0.0);
      for (const BasisValue& v : values) dense[v.function] = v.value;
      const std::vector<Jet> expected = reference.evaluate_all(points[i]);
      for (std::size_t f = 0; f < dense.size(); ++f) {
        const double error = std::abs(dense[f] - expected[f].value);
        if (!(error <= worst)) {
          worst = error;
          worst_at = points[i];
        }
      }
    }
    EXPECT_LE(worst, 1e-10) << "at " << worst_at.x << ' ' << worst_at.y << '\n' << c.to_text();
  }
}

TEST_P(SplineLaws, LinearFunctionsAreReproducedFromGrevilleSites) {
  for (const MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.name);
    const auto space = make_space(c, GetParam());
    const Basis basis(space);
    std::vector<BasisValue> values;
    double worst = 0;
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kLawsSeed, 100)) {
      basis.evaluate(u, values);
      Vec2 sum;
      for (const BasisValue& v : values) sum = sum + v.value * space->greville(v.function);
      worst = std::max(worst, norm(sum - u) / std::max(c.mesh.width, c.mesh.height));
    }
    EXPECT_LE(worst, 1e-9) << c.to_text();
  }
}

}  // namespace
}  // namespace knotreel::spline
