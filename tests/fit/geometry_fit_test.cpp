// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/geometry_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <map>

#include "fit/fit_cases.h"
#include "knotreel/base/parallel.h"
#include "knotreel/fit/pixel_places.h"
#include "support/dense.h"
#include "support/models.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;
using spline::PixelValues;

bool on_border(const spline::SplineSpace& space, Vec2 site) {
  return site.x <= 0 || site.y <= 0 || site.x >= space.mesh().width || site.y >= space.mesh().height;
}

/// Displaced control points, at rest on the border.
document::FrameModel displaced_model(int degree, double reach, std::uint64_t seed) {
  document::FrameModel model = blank_model(featured_mesh(seed), degree, 1);
  displace_randomly(model, reach, seed);
  const std::vector<Vec2> sites = model.space->geometry_greville();
  for (std::size_t g = 0; g < sites.size(); ++g) {
    if (on_border(*model.space, sites[g])) model.displacement[g] = {};
  }
  return model;
}

/// Where the geometry takes u, from the control points themselves.
Vec2 image_of(const spline::Basis& basis, std::span<const Vec2> displacement, Vec2 u) {
  const spline::SplineSpace& space = basis.space();
  std::vector<spline::BasisValue> values;
  basis.evaluate(u, values);
  Vec2 sum;
  for (const auto& v : values) {
    sum = sum + v.value * (space.greville(v.function) + displacement[space.geometry_of()[v.function]]);
  }
  return sum;
}

std::vector<CurvePoint> curve_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                                     Vec2 offset) {
  std::vector<CurvePoint> curves;
  const auto& mesh = basis.space().mesh();
  for (const auto& s : mesh.segments) {
    const Vec2 from = mesh.knots[s.knots.front()].position;
    const Vec2 to = mesh.knots[s.knots.back()].position;
    for (int i = 1; i < 20; ++i) {
      const Vec2 u = from + (i / 20.0) * (to - from);
      curves.push_back({u, image_of(basis, displacement, u) + offset});
    }
  }
  return curves;
}

class Geometry : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Geometry, ::testing::Values(1, 2, 3));

TEST_P(Geometry, PlacesOfPixelsGoToTheirCentres) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const double reach : {0.25, 3.0}) {
      const auto model = displaced_model(GetParam(), reach, seed);
      const spline::Basis basis(model.space);
      const std::vector<Vec2> places = pixel_places(basis, model.displacement, 48, 40);
      ASSERT_EQ(places.size(), 48u * 40u);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec2 p = image_of(basis, model.displacement, places[i]);
        ASSERT_LE(norm(p - pixel_centre(i, 48)), 3e-3) << "pixel " << i << " reach " << reach;
      }
    }
  }
}

/// One control point is somewhere else; only around it places are looked for again.
TEST_P(Geometry, PlacesThatAreKnownServeAgain) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    auto model = displaced_model(GetParam(), 0.5, seed);
    const spline::Basis basis(model.space);
    const std::vector<Vec2> before = pixel_places(basis, model.displacement, 48, 40);
    const PixelValues values(basis, 48, 40, before);
    const std::vector<Vec2> sites = model.space->geometry_greville();
    std::size_t moved = 0;
    while (on_border(*model.space, sites[moved]) || norm(sites[moved] - Vec2{10, 10}) > 8) ++moved;
    model.displacement[moved] = model.displacement[moved] + Vec2{0.5, -0.25};
    std::vector<PlacesOfTile> tiles(values.tile_count(), PlacesOfTile::kKnown);
    std::vector<std::uint8_t> functions(model.space->function_count(), 1);
    std::size_t known = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      for (const spline::FunctionIndex f : values.functions(t)) {
        if (model.space->geometry_of()[f] == moved) tiles[t] = PlacesOfTile::kUnknown;
      }
      known += tiles[t] == PlacesOfTile::kKnown ? 1 : 0;
    }
    ASSERT_GT(known, 0u);
    ASSERT_LT(known, tiles.size());
    const std::vector<Vec2> again =
        pixel_places(basis, model.displacement, 48, 40, {before, tiles, functions});
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      values.for_pixels(t, [&](std::size_t pixel, std::size_t) {
        if (tiles[t] == PlacesOfTile::kKnown) {
          EXPECT_EQ(again[pixel], before[pixel]);
        }
        const Vec2 p = image_of(basis, model.displacement, again[pixel]);
        EXPECT_LE(norm(p - pixel_centre(pixel, 48)), 3e-3) << "pixel " << pixel;
      });
    }
  }
}

TEST_P(Geometry, TheIdentityIsExact) {
  const auto space = make_space(featured_mesh(1), GetParam());
  const spline::Basis basis(space);
  const std::vector<Vec2> none(space->geometry_count());
  std::vector<Vec2> centres(48 * 40);
  for (std::size_t i = 0; i < centres.size(); ++i) centres[i] = pixel_centre(i, 48);
  const PixelValues values(basis, 48, 40, centres);
  EXPECT_EQ(pixel_places(basis, none, 48, 40), centres);
  EXPECT_EQ(fit_geometry(values, centres, {}), none);
  EXPECT_EQ(fit_geometry(values, {}, {}), none);
  const std::vector<CurvePoint> curves = curve_points(basis, none, {1, 1});
  EXPECT_EQ(fit_geometry(values, centres, curves), none);
}

TEST_P(Geometry, DisplacementsComeBack) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto model = displaced_model(GetParam(), 1.0, seed);
    const spline::Basis basis(model.space);
    const std::vector<Vec2> places = pixel_places(basis, model.displacement, 48, 40);
    const PixelValues values(basis, 48, 40, places);
    const std::vector<CurvePoint> curves = curve_points(basis, model.displacement, {});
    const std::vector<Vec2> fitted = fit_geometry(values, places, curves, {.ridge = 1e-8, .least = 0});
    const std::vector<Vec2> sites = model.space->geometry_greville();
    for (std::size_t g = 0; g < sites.size(); ++g) {
      if (on_border(*model.space, sites[g])) {
        EXPECT_EQ(fitted[g], Vec2{});
      }
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vec2 miss = image_of(basis, fitted, places[i]) - image_of(basis, model.displacement, places[i]);
      ASSERT_LE(norm(miss), 0.02) << i;
    }
  }
}

/// The normal equations, with dense matrices.
TEST_P(Geometry, NoDisplacementIsBetter) {
  const auto space = make_space(featured_mesh(4), GetParam());
  const spline::Basis basis(space);
  const std::vector<Vec2> places = scattered_places(48, 40, 1.0, 9);
  const std::vector<CurvePoint> curves =
      curve_points(basis, std::vector<Vec2>(space->geometry_count()), {0.7, -0.4});
  const GeometryFitOptions options{.feature_weight = 13, .ridge = 1e-3, .least = 0};
  const std::vector<Vec2> sites = space->geometry_greville();
  const auto n = static_cast<Eigen::Index>(sites.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
  std::vector<spline::BasisValue> values;
  const auto add = [&](Vec2 u, Vec2 target, double weight) {
    basis.evaluate(u, values);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    for (const auto& v : values) row[space->geometry_of()[v.function]] += v.value;
    matrix += weight * row * row.transpose();
    right += weight * row * Eigen::RowVector2d(target.x - u.x, target.y - u.y);
  };
  for (std::size_t i = 0; i < places.size(); ++i) add(places[i], pixel_centre(i, 48), 1);
  for (const CurvePoint& p : curves) add(p.parameter, p.position, options.feature_weight);
  double largest = 1;
  for (Eigen::Index g = 0; g < n; ++g) {
    if (!on_border(*space, sites[std::size_t(g)])) largest = std::max(largest, matrix(g, g));
  }
  const std::vector<Vec2> fitted = fit_geometry(PixelValues(basis, 48, 40, places), places, curves, options);
  Eigen::MatrixXd c(n, 2);
  for (Eigen::Index g = 0; g < n; ++g) c.row(g) << fitted[std::size_t(g)].x, fitted[std::size_t(g)].y;
  const Eigen::MatrixXd gradient = testing::product(matrix, c) - right + options.ridge * largest * c;
  double moved = 0;
  for (Eigen::Index g = 0; g < n; ++g) {
    if (on_border(*space, sites[std::size_t(g)])) {
      EXPECT_EQ(fitted[std::size_t(g)], Vec2{});
    } else {
      EXPECT_LE(gradient.row(g).norm(), 1e-4) << g;  // targets are floats
      moved = std::max(moved, norm(fitted[std::size_t(g)]));
    }
  }
  EXPECT_GT(moved, 0.2);

  // Displacements below the least one are dropped, others stay.
  GeometryFitOptions coarse = options;
  coarse.least = 0.15;
  const std::vector<Vec2> kept = fit_geometry(PixelValues(basis, 48, 40, places), places, curves, coarse);
  int dropped = 0;
  for (std::size_t g = 0; g < kept.size(); ++g) {
    const bool small = norm(fitted[g]) < coarse.least;
    dropped += small && fitted[g] != Vec2{};
    EXPECT_EQ(kept[g], small ? Vec2{} : fitted[g]);
  }
  EXPECT_GT(dropped, 0);
}

TEST_P(Geometry, FunctionsFarFromDisplacedPixelsStay) {
  const auto space = make_space(featured_mesh(4), GetParam());
  const spline::Basis basis(space);
  std::vector<Vec2> places(48 * 40);
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = pixel_centre(i, 48);
  const std::size_t displaced = 15 * 48 + 12;
  places[displaced] = places[displaced] + Vec2{0.5, 0.25};
  const PixelValues pixel_values(basis, 48, 40, places);
  const std::vector<Vec2> fitted = fit_geometry(pixel_values, places, {}, {.least = 0});
  std::vector<bool> near(space->geometry_count(), false);
  std::vector<spline::BasisValue> values;
  basis.evaluate(places[displaced], values);
  for (const auto& v : values) near[space->geometry_of()[v.function]] = true;
  int moved = 0;
  const std::vector<Vec2> sites = space->geometry_greville();
  for (std::size_t g = 0; g < fitted.size(); ++g) {
    if (fitted[g] == Vec2{}) {
      EXPECT_FALSE(near[g] && !on_border(*space, sites[g])) << g;
    } else {
      ++moved;
      // Rows of values are a little generous, supports a few faces wide.
      EXPECT_LT(norm(sites[g] - places[displaced]), 24) << g;
    }
  }
  EXPECT_GT(moved, 0);
}

TEST_P(Geometry, TheNumberOfThreadsDoesNotMatter) {
  const auto model = displaced_model(GetParam(), 1.0, 1);
  const spline::Basis basis(model.space);
  std::vector<Vec2> places[2];
  std::vector<Vec2> fitted[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i + 1);
    places[i] = pixel_places(basis, model.displacement, 48, 40);
    const PixelValues values(basis, 48, 40, places[i]);
    fitted[i] = fit_geometry(values, places[i], {});
  }
  EXPECT_EQ(places[0], places[1]);
  EXPECT_EQ(fitted[0], fitted[1]);
}

/// Every pixel with a good length of a feature in it is crossed, and no other.
TEST_P(Geometry, CrossedPixelsAreThoseOnFeatures) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto model = displaced_model(GetParam(), 2.0, seed);
    const spline::Basis basis(model.space);
    const auto& mesh = model.space->mesh();
    std::map<std::size_t, double> lengths;  // of features in pixels
    for (const auto& s : mesh.segments) {
      const Vec2 from = mesh.knots[s.knots.front()].position;
      const Vec2 to = mesh.knots[s.knots.back()].position;
      const int samples = static_cast<int>(norm(to - from) / 0.002);
      Vec2 last = image_of(basis, model.displacement, from);
      for (int i = 0; i <= samples; ++i) {
        const Vec2 p = image_of(basis, model.displacement, from + (double(i) / samples) * (to - from));
        const int x = std::clamp(static_cast<int>(std::floor(p.x)), 0, 47);
        const int y = std::clamp(static_cast<int>(std::floor(p.y)), 0, 39);
        lengths[std::size_t(y) * 48 + std::size_t(x)] += norm(p - last);
        last = p;
      }
    }
    const auto crossed = crossed_pixels(basis, model.displacement, 48, 40);
    ASSERT_EQ(crossed.size(), 48u * 40u);
    for (std::size_t i = 0; i < crossed.size(); ++i) {
      const auto found = lengths.find(i);
      const double length = found == lengths.end() ? -1 : found->second;
      // Curves are sampled every 0.2 pixels of the domain: corners cut off may be missed.
      if (length < 0) {
        EXPECT_EQ(crossed[i], 0) << i;
      } else if (length > 0.45) {
        EXPECT_EQ(crossed[i], 1) << i << " length " << length;
      }
    }
  }
}

TEST(GeometryErrors, AreDistances) {
  MeshBuilder b(20, 16);
  const mesh::KnotIndex knot = b.free(8, 7);
  const auto space = make_space(b.triangulated(), 1);
  const spline::Basis basis(space);
  std::vector<Vec2> displacement(space->geometry_count());
  std::vector<spline::BasisValue> values;
  basis.evaluate(space->mesh().knots[knot].position, values);
  for (const auto& v : values) {
    if (v.value > 0.5) displacement[space->geometry_of()[v.function]] = {1, -2};
  }
  // Degree 1: the displacement is linear from the knot to the corners of the domain.
  const std::vector<CurvePoint> curves{{{8, 7}, {9, 5}},     {{8, 7}, {12, 9}}, {{4, 3.5}, {4.5, 2.5}},
                                       {{4, 3.5}, {4.5, 5}}, {{0, 0}, {0, 3}},  {{20, 16}, {20, 16}}};
  const std::vector<double> errors = geometry_errors(basis, displacement, curves);
  const double expected[] = {0, 5, 0, 2.5, 3, 0};
  ASSERT_EQ(errors.size(), std::size(expected));
  for (std::size_t i = 0; i < errors.size(); ++i) EXPECT_NEAR(errors[i], expected[i], 1e-12) << i;
}

}  // namespace
}  // namespace knotreel::fit
