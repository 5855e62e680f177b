// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/spline/basis.h"
#include "knotreel/spline/smooth_corners.h"
#include "spline/law_cases.h"

/// Smoothness of random surfaces across every line on which pieces meet, by exact one-sided limits.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kContinuitySeed = 20260202;

/// A point on the straight line between two knots of one config, and the unit normal of that line.
struct CreasePoint {
  Vec2 at;
  Vec2 normal;
  bool at_multiple;  ///< one of the two knots is multiple
};

bool on_common_line(const mesh::CutMesh& cut, CornerIndex a, CornerIndex b) {
  const auto& p = cut.corners[a];
  const auto& q = cut.corners[b];
  for (const std::uint32_t l : {p.first_line, p.last_line}) {
    if (l != mesh::kNoLine && (l == q.first_line || l == q.last_line)) return true;
  }
  return false;
}

/// Points on all creases off the features and the border.
std::vector<CreasePoint> crease_points(const SplineSpace& space, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  std::vector<CreasePoint> points;
  for (const Config& config : space.configs()) {
    std::vector<CornerIndex> all(config.triangle.begin(), config.triangle.end());
    for (const CornerIndex c : config.inner) {
      if (c != kNoCorner) all.push_back(c);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        if (on_common_line(space.cut(), all[i], all[j])) continue;
        const Vec2 a = space.position(all[i]);
        const Vec2 e = space.position(all[j]) - a;
        if (norm(e) == 0) continue;
        points.push_back({a + unit(random) * e,
                          {-e.y / norm(e), e.x / norm(e)},
                          space.cut().corners[all[i]].multiple || space.cut().corners[all[j]].multiple});
      }
    }
  }
  return points;
}

/// Whether the point lies on a feature (the crease crosses one there by chance).
bool near_feature(const SplineSpace& space, Vec2 u) {
  const auto& lines = space.cut().lines;
  for (std::size_t l = 0; l < space.mesh().segments.size(); ++l) {
    const Vec2 e = lines[l].to - lines[l].from;
    const double t = std::clamp(dot(u - lines[l].from, e) / dot(e, e), 0.0, 1.0);
    if (norm(u - (lines[l].from + t * e)) < 1e-6) return true;
  }
  return false;
}

struct Jumps {
  double value = 0;
  double gradient = 0;
  double hessian = 0;
};

/// Largest jumps of the surface with control values c, relative to the sum of magnitudes that cancel there.
Jumps measure(const Basis& basis, const std::vector<double>& c, const std::vector<CreasePoint>& points,
              bool skip_multiple) {
  Jumps worst;
  std::vector<BasisJet> jets;
  for (const CreasePoint& p : points) {
    if ((skip_multiple && p.at_multiple) || near_feature(basis.space(), p.at)) continue;
    Jet difference;
    double scale0 = 1;
    double scale1 = 1;
    double scale2 = 1;
    for (const double side : {1.0, -1.0}) {
      basis.evaluate(p.at, side * p.normal, jets);
      for (const BasisJet& b : jets) {
        const double w = side * c[b.function];
        difference.value += w * b.jet.value;
        difference.dx += w * b.jet.dx;
        difference.dy += w * b.jet.dy;
        difference.dxx += w * b.jet.dxx;
        difference.dxy += w * b.jet.dxy;
        difference.dyy += w * b.jet.dyy;
        scale0 += std::abs(w * b.jet.value);
        scale1 += std::abs(w) * (std::abs(b.jet.dx) + std::abs(b.jet.dy));
        scale2 += std::abs(w) * (std::abs(b.jet.dxx) + std::abs(b.jet.dxy) + std::abs(b.jet.dyy));
      }
    }
    worst.value = std::max(worst.value, std::abs(difference.value) / scale0);
    worst.gradient = std::max(worst.gradient, std::hypot(difference.dx, difference.dy) / scale1);
    worst.hessian =
        std::max(worst.hessian, std::hypot(difference.dxx, difference.dxy, difference.dyy) / scale2);
  }
  return worst;
}

std::vector<MeshCase> cases() {
  std::vector<MeshCase> all = knotreel::testing::law_cases(kContinuitySeed, 200);
  std::erase_if(all, [](const MeshCase& c) { return knotreel::testing::has_accidental_lines(c.mesh); });
  return all;
}

class Continuity : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Continuity, ::testing::Values(1, 2, 3));

TEST_P(Continuity, AcrossLinesOfSimpleKnots) {
  std::mt19937_64 random(kContinuitySeed);
  std::normal_distribution<double> normal;
  for (const MeshCase& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    std::vector<double> control(space->function_count());
    for (double& v : control) v = normal(random);
    const auto points = crease_points(*space, random);
    const Jumps everywhere = measure(basis, control, points, false);
    const Jumps simple = measure(basis, control, points, true);
    EXPECT_LE(everywhere.value, 1e-9) << c.to_text();
    if (GetParam() >= 2) {
      EXPECT_LE(simple.gradient, 1e-7) << c.to_text();
    }
    if (GetParam() >= 3) {
      EXPECT_LE(simple.hessian, 1e-6) << c.to_text();
    }
  }
}

TEST_P(Continuity, EverywhereOffTheFeaturesWithCornerSmoothing) {
  std::mt19937_64 random(kContinuitySeed + 1);
  std::normal_distribution<double> normal;
  double unsmoothed = 0;
  for (const MeshCase& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Eigen::SparseMatrix<double> prolongation = smooth_corner_prolongation(*space);
    Eigen::VectorXd z(prolongation.cols());
    for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = normal(random);
    const Eigen::VectorXd smooth = prolongation * z;
    const std::vector<double> control(smooth.begin(), smooth.end());
    const auto points = crease_points(*space, random);
    const Jumps jumps = measure(basis, control, points, false);
    EXPECT_LE(jumps.value, 1e-9) << c.to_text();
    if (GetParam() >= 2) {
      EXPECT_LE(jumps.gradient, 1e-7) << c.to_text();
    }
    if (GetParam() >= 3) {
      EXPECT_LE(jumps.hessian, 1e-6) << c.to_text();
    }
    std::vector<double> rough(control.size());
    for (double& v : rough) v = normal(random);
    unsmoothed = std::max(unsmoothed, measure(basis, rough, points, false).gradient);
  }
  if (GetParam() >= 2) {
    EXPECT_GT(unsmoothed, 1e-3) << "without smoothing the jump must be there, or this test sees nothing";
  }
}

/// A point of a feature segment with a direction to its left.
struct FeaturePoint {
  Vec2 at;
  Vec2 normal;
};

std::vector<FeaturePoint> feature_points(const SplineSpace& space, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.001, 0.999);
  std::vector<FeaturePoint> points;
  for (std::size_t s = 0; s < space.mesh().segments.size(); ++s) {
    const mesh::Line& line = space.cut().lines[s];
    const Vec2 e = line.to - line.from;
    // Not quite the normal: that may run along an edge that ends here, which would choose no side of it.
    const Vec2 away{(-e.y + 0.1234 * e.x) / norm(e), (e.x + 0.1234 * e.y) / norm(e)};
    for (int i = 0; i < 20; ++i) points.push_back({line.from + unit(random) * e, away});
    for (const mesh::KnotIndex k : space.mesh().segments[s].knots) {
      if (space.mesh().knots[k].kind == mesh::KnotKind::kSegment) {
        points.push_back({space.mesh().knots[k].position, away});
      }
    }
  }
  return points;
}

TEST_P(Continuity, OnlyFunctionsOfOpenTipsReachAcrossAFeature) {
  std::mt19937_64 random(kContinuitySeed + 2);
  for (const MeshCase& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const auto is_tip_function = [&](FunctionIndex f) {
      const CornerIndex a = space->functions()[f].knots[0];
      for (int i = 1; i < GetParam(); ++i) {
        const CornerIndex b = space->functions()[f].knots[static_cast<std::size_t>(i)];
        if (b != a) return false;
      }
      const auto& corner = space->cut().corners[a];
      return corner.multiple && corner.first_line == corner.last_line;
    };
    std::vector<BasisValue> values;
    for (const FeaturePoint& p : feature_points(*space, random)) {
      std::vector<double> left(space->function_count(), 0.0);
      basis.evaluate(p.at, p.normal, values);
      for (const BasisValue& v : values) left[v.function] = v.value;
      basis.evaluate(p.at, -1.0 * p.normal, values);
      for (const BasisValue& v : values) {
        if (v.value > 1e-9 && left[v.function] > 1e-9) {
          EXPECT_TRUE(is_tip_function(v.function)) << c.to_text();
          EXPECT_NEAR(v.value, left[v.function], 1e-9) << "a tip's own function is not split\n"
                                                       << c.to_text();
        }
      }
    }
  }
}

TEST_P(Continuity, GeometryIsContinuousAcrossFeatures) {
  std::mt19937_64 random(kContinuitySeed + 3);
  std::normal_distribution<double> normal;
  for (const MeshCase& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    std::vector<double> groups(space->geometry_count());
    for (double& v : groups) v = normal(random);
    std::vector<BasisValue> values;
    for (const FeaturePoint& p : feature_points(*space, random)) {
      double jump = 0;
      for (const double side : {1.0, -1.0}) {
        basis.evaluate(p.at, side * p.normal, values);
        for (const BasisValue& v : values) {
          jump += side * v.value * groups[space->geometry_of()[v.function]];
        }
      }
      EXPECT_NEAR(jump, 0, 1e-9) << c.to_text();
    }
  }
}

}  // namespace
}  // namespace knotreel::spline
