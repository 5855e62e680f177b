// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/mesh/triangulate.h"
#include "knotreel/spline/basis.h"
#include "knotreel/spline/link.h"
#include "spline/law_cases.h"
#include "support/dense.h"

/// The ways to evaluate agree with each other; polynomials are reproduced; spaces come back from their codes.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kEvaluationSeed = 20260303;

std::vector<MeshCase> cases(int random_count) {
  return knotreel::testing::law_cases(kEvaluationSeed, random_count);
}

class Evaluation : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Evaluation, ::testing::Values(1, 2, 3));

TEST_P(Evaluation, ScatteredPointsEqualSinglePointsWithAnyNumberOfThreads) {
  const MeshCase c = knotreel::testing::random_cases(kEvaluationSeed, 1).front();
  const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
  const Basis basis(space);
  const std::vector<Vec2> points = knotreel::testing::probe_points(c.mesh, kEvaluationSeed, 20000);
  ScatteredValues results[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i == 0 ? 1 : 4);
    results[i] = basis.evaluate(points);
  }
  ASSERT_EQ(results[0].begin, results[1].begin);
  ASSERT_EQ(results[0].values.size(), results[1].values.size());
  for (std::size_t i = 0; i < results[0].values.size(); ++i) {
    ASSERT_EQ(results[0].values[i].function, results[1].values[i].function);
    ASSERT_EQ(results[0].values[i].value, results[1].values[i].value);
  }
  std::vector<BasisValue> single;
  for (std::size_t i = 0; i < points.size(); ++i) {
    basis.evaluate(points[i], single);
    ASSERT_EQ(single.size(), results[0].begin[i + 1] - results[0].begin[i]);
    for (std::size_t j = 0; j < single.size(); ++j) {
      ASSERT_EQ(single[j].value, results[0].values[results[0].begin[i] + j].value);
    }
  }
}

TEST_P(Evaluation, DerivativesEqualTheRecurrenceAndDifferences) {
  std::mt19937_64 random(kEvaluationSeed);
  for (const MeshCase& c : cases(30)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const ReferenceBasis reference(*space);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<BasisJet> jets;
    for (int i = 0; i < 10; ++i) {
      const Vec2 u{unit(random) * c.mesh.width, unit(random) * c.mesh.height};
      const Vec2 d = inward_direction(u, c.mesh.width, c.mesh.height);
      basis.evaluate(u, d, jets);
      for (const BasisJet& b : jets) {
        const Jet r = reference.evaluate(b.function, u, d);
        const double g = 1e-8 * (1 + std::abs(r.dx) + std::abs(r.dy));
        const double h = 1e-7 * (1 + std::abs(r.dxx) + std::abs(r.dxy) + std::abs(r.dyy));
        EXPECT_NEAR(b.jet.dx, r.dx, g);
        EXPECT_NEAR(b.jet.dy, r.dy, g);
        EXPECT_NEAR(b.jet.dxx, r.dxx, h);
        EXPECT_NEAR(b.jet.dxy, r.dxy, h);
        EXPECT_NEAR(b.jet.dyy, r.dyy, h);
        // Differences: polynomial nearly everywhere, so a small step sees no knot line but by bad luck.
        const double e = 1e-6;
        const double dx = (reference.evaluate(b.function, {u.x + e, u.y}, d).value -
                           reference.evaluate(b.function, {u.x - e, u.y}, d).value) /
                          (2 * e);
        EXPECT_NEAR(b.jet.dx, dx, 1e-3 * (1 + std::abs(r.dx)) + e * std::abs(r.dxx));
      }
    }
  }
}

/// Polar form of x^2, xy, y^2 (degree 2) at two knots; for degree 3 that of x^2 times 1 at three knots.
double polar(int which, const std::vector<Vec2>& k) {
  double sum = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    for (std::size_t j = 0; j < k.size(); ++j) {
      if (i == j) continue;
      ++pairs;
      sum += which == 0 ? k[i].x * k[j].x : which == 1 ? k[i].x * k[j].y : k[i].y * k[j].y;
    }
  }
  return sum / pairs;
}

double monomial(int which, Vec2 u) {
  return which == 0 ? u.x * u.x : which == 1 ? u.x * u.y : u.y * u.y;
}

TEST_P(Evaluation, QuadraticsAreReproducedByTheirPolarForms) {
  if (GetParam() < 2) return;
  for (const MeshCase& c : cases(200)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    std::vector<BasisValue> values;
    double worst = 0;
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kEvaluationSeed, 50)) {
      basis.evaluate(u, values);
      for (int which = 0; which < 3; ++which) {
        double sum = 0;
        for (const BasisValue& v : values) {
          std::vector<Vec2> knots;
          for (int i = 0; i < GetParam(); ++i) {
            knots.push_back(
                space->position(space->functions()[v.function].knots[static_cast<std::size_t>(i)]));
          }
          sum += v.value * polar(which, knots);
        }
        worst = std::max(worst, std::abs(sum - monomial(which, u)));
      }
    }
    EXPECT_LE(worst / (c.mesh.width * c.mesh.width + c.mesh.height * c.mesh.height), 1e-9) << c.to_text();
  }
}

TEST_P(Evaluation, QuadraticsAreReproducedByFitting) {
  if (GetParam() < 2) return;
  std::mt19937_64 random(kEvaluationSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const MeshCase& c : cases(20)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    if (space->function_count() > knotreel::testing::kMostDenseFunctions) continue;
    const auto n = static_cast<Eigen::Index>(space->function_count());
    const auto f = [&](Vec2 u) {
      const double x = u.x / c.mesh.width;
      const double y = u.y / c.mesh.height;
      return 3 + x - 2 * y + 5 * x * x - 4 * x * y + 2 * y * y;
    };
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(12 * n, n);
    Eigen::VectorXd b(12 * n);
    std::vector<BasisValue> values;
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const Vec2 u{unit(random) * c.mesh.width, unit(random) * c.mesh.height};
      basis.evaluate(u, values);
      for (const BasisValue& v : values) a(i, v.function) = v.value;
      b[i] = f(u);
    }
    const Eigen::VectorXd x = knotreel::testing::least_squares(a, b);
    EXPECT_LE((a * x - b).lpNorm<Eigen::Infinity>(), 1e-8) << c.to_text();
  }
}

TEST_P(Evaluation, SpacesComeBackFromTheirLinkCodes) {
  std::mt19937_64 random(kEvaluationSeed);
  const LinkPolicy any = [&](const LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
    // A random triangulation: always split at a random apex.
    const auto split = [&](auto&& self, std::size_t i, std::size_t j) -> void {
      if (j - i <= 2) {
        return;
      }
      const auto k = std::uniform_int_distribution<std::size_t>(i + 1, j - 1)(random);
      codes.push_back(static_cast<std::uint16_t>(k - i - 1));
      self(self, i, k);
      self(self, k, j);
    };
    split(split, 0, polygon.corners.size() - 1);
  };
  for (const MeshCase& c : cases(40)) {
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam(), any);
    const SplineSpace again = SplineSpace::from_link_codes(c.mesh, GetParam(), space.link_codes());
    ASSERT_EQ(space.function_count(), again.function_count());
    ASSERT_EQ(0, std::memcmp(space.configs().data(), again.configs().data(), space.configs().size_bytes()));
    // Any triangulation, even one that is turned inside out in places, keeps partition of unity.
    const Basis basis(std::make_shared<const SplineSpace>(again));
    std::vector<BasisValue> values;
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kEvaluationSeed, 20)) {
      basis.evaluate(u, values);
      double sum = 0;
      for (const BasisValue& v : values) sum += v.value;
      EXPECT_NEAR(sum, 1, 1e-7);
    }
    if (!space.link_codes().empty()) {
      const auto shorter = space.link_codes().first(space.link_codes().size() - 1);
      EXPECT_THROW(SplineSpace::from_link_codes(c.mesh, GetParam(), shorter), Error);
    }
  }
}

TEST_P(Evaluation, LinksAreVisitedWithTheirCodes) {
  for (const MeshCase& c : cases(20)) {
    SCOPED_TRACE(c.name);
    // What the policy is asked for, in that order, is what is visited later.
    std::vector<std::vector<CornerIndex>> asked;
    const auto name = [](const LinkPolygon& polygon) {
      std::vector<CornerIndex> all(polygon.vertex.begin(), polygon.vertex.end());
      all.insert(all.end(), polygon.corners.begin(), polygon.corners.end());
      return all;
    };
    const SplineSpace space(
        c.mesh, GetParam(), [&](const LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
          asked.push_back(name(polygon));
          encode_triangulation(polygon.corners.size(), triangulate_polygon(polygon.positions), codes);
        });
    std::vector<std::vector<CornerIndex>> visited;
    std::vector<std::uint16_t> codes;
    for_each_link(space, [&](const LinkPolygon& polygon, std::span<const std::uint16_t> of_link,
                             std::span<const PolygonTriangle> triangles) {
      visited.push_back(name(polygon));
      codes.insert(codes.end(), of_link.begin(), of_link.end());
      EXPECT_EQ(triangles.size(), polygon.corners.size() - 2);
    });
    EXPECT_EQ(visited, asked);
    EXPECT_TRUE(std::equal(codes.begin(), codes.end(), space.link_codes().begin(), space.link_codes().end()));
  }
}

/// Long faces that all meet in one corner of the domain: each crosses as many cells of the index as there are
/// in a quarter of the domain, on average.
mesh::KnotMesh fan(std::uint32_t count) {
  mesh::KnotMesh mesh = mesh::make_domain(1000000, 1000000);
  for (std::uint32_t i = 1; i < count; ++i) {
    mesh.knots.push_back({{1000000, i * (1000000.0 / count)}, mesh::KnotKind::kBorder, mesh::KnotId{i + 3}});
  }
  const auto at = [&](std::uint32_t i) -> mesh::KnotIndex { return i == 0 ? 1 : i == count ? 2 : i + 3; };
  for (std::uint32_t i = 0; i < count; ++i) mesh.faces.push_back({0, at(i), at(i + 1)});
  mesh.faces.push_back({0, 2, 3});
  return mesh;
}

TEST(TermIndex, NeedsFewEntriesForAFanOfSlivers) {
  const mesh::KnotMesh mesh = fan(96000);
  const Basis basis(std::make_shared<const SplineSpace>(mesh, 1));
  const mesh::CutMesh& cut = basis.space().cut();
  ASSERT_LE(basis.index().entry_count(), 64 * basis.pieces().terms.size());
  std::vector<BasisValue> values;
  for (const Vec2 u : {Vec2{500000.3, 400000.2}, {999999.5, 3.7}, {20.25, 11.5}, {2000, 999000}}) {
    basis.evaluate(u, values);
    double sum = 0;
    Vec2 place;
    for (const BasisValue& b : values) {
      sum += b.value;
      place = place +
              b.value * mesh.knots[cut.corners[basis.space().functions()[b.function].knots[0]].knot].position;
    }
    EXPECT_NEAR(sum, 1, 1e-10);
    EXPECT_NEAR(norm(place - u), 0, 1e-4);
  }
}

TEST(LinkCodes, EveryTriangulationOfSmallPolygonsComesBack) {
  // All code sequences of polygons up to 7 corners: 1, 2, 5, 14, 42 triangulations.
  const std::size_t catalan[] = {1, 2, 5, 14, 42};
  for (std::size_t n = 3; n <= 7; ++n) {
    std::size_t found = 0;
    std::vector<std::uint16_t> codes;
    const auto explore = [&](auto&& self) -> void {
      std::vector<PolygonTriangle> triangles;
      const auto used = decode_triangulation(n, codes, triangles);
      if (used) {
        if (*used != codes.size()) return;
        EXPECT_EQ(triangles.size(), n - 2);
        std::vector<std::uint16_t> again;
        encode_triangulation(n, triangles, again);
        EXPECT_EQ(again, codes);
        ++found;
        return;
      }
      if (codes.size() >= n) return;
      for (std::uint16_t c = 0; c < n; ++c) {
        codes.push_back(c);
        self(self);
        codes.pop_back();
      }
    };
    explore(explore);
    EXPECT_EQ(found, catalan[n - 3]);
  }
}

}  // namespace
}  // namespace knotreel::spline
