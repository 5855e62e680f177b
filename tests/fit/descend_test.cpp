// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/descend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fit/fit_cases.h"
#include "knotreel/base/parallel.h"
#include "knotreel/mesh/knot_mesh.h"
#include "support/pictures.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;
using mesh::KnotIndex;
using mesh::KnotKind;

image::Image picture(int channels) {
  image::Image image = test::random_picture(48, 40, channels, 21);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    const Vec2 p = pixel_centre(i / std::size_t(channels), 48);
    const double v = 110 + 90 * std::tanh((p.x + 0.4 * p.y - 33) / 2.5) + 20 * std::sin(0.4 * p.y);
    image.samples[i] = static_cast<float>(v) + 0.05F * image.samples[i];
  }
  return image;
}

ColourSurface start(const mesh::KnotMesh& mesh, int degree, const Pixels& pixels,
                    const ColourFitOptions& options = {}) {
  ColourSurface surface{make_space(mesh, degree), {}};
  surface.fit = fit_colours(spline::Basis(surface.space), pixels, options);
  return surface;
}

double most_apart(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

void expect_sound(const spline::SplineSpace& space) {
  EXPECT_EQ(mesh::find_defect(space.mesh()).value_or(""), "");
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(space));
  std::vector<spline::BasisValue> values;
  for (const Vec2 u : probe_points(space.mesh(), 3, 500)) {
    basis.evaluate(u, values);
    double sum = 0;
    for (const auto& v : values) {
      ASSERT_GE(v.value, -1e-9);
      sum += v.value;
    }
    ASSERT_NEAR(sum, 1, 1e-9);
  }
}

class Descent : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Descent, ::testing::Values(1, 2, 3));

TEST_P(Descent, KnotsOnCurvesStayIfAsked) {
  const image::Image image = picture(3);
  const Pixels pixels{&image, {}, {}};
  const ColourSurface from = start(featured_mesh(1), GetParam(), pixels);
  const ColourSurface to = descend(from, pixels, {.steps = 4, .along_curves = false});
  std::size_t moved = 0;
  for (KnotIndex k = 0; k < from.space->mesh().knots.size(); ++k) {
    const mesh::Knot& before = from.space->mesh().knots[k];
    const bool stays = before.position == to.space->mesh().knots[k].position;
    EXPECT_TRUE(stays || before.kind != KnotKind::kSegment) << k;
    if (!stays) ++moved;
  }
  EXPECT_GT(moved, 0u);
}

TEST_P(Descent, NeverEndsWorseAndStaysSound) {
  const image::Image image = picture(3);
  const std::vector<Vec2> places = scattered_places(48, 40, 0.8, 5);
  const std::vector<float> weights = random_weights(48 * 40, 6);
  for (const std::uint64_t seed : {1, 2, 3}) {
    // Steps up to far too long ones.
    for (const double step : {0.05, 0.3, 3.0}) {
      const Pixels pixels{&image, seed == 2 ? weights : std::span<const float>{},
                          seed == 3 ? places : std::span<const Vec2>{}};
      const ColourSurface from = start(featured_mesh(seed), GetParam(), pixels);
      const ColourSurface to = descend(from, pixels, {.steps = 6, .first_step = step});
      EXPECT_LE(to.fit.squared_error, from.fit.squared_error);
      expect_sound(*to.space);
      // The colours are those of the mesh.
      const ColourFit again = fit_colours(spline::Basis(to.space), pixels);
      EXPECT_LT(most_apart(again.control, to.fit.control), 0.05);
      EXPECT_NEAR(again.squared_error, to.fit.squared_error, 1e-6 * again.squared_error);

      const mesh::KnotMesh& a = from.space->mesh();
      const mesh::KnotMesh& b = to.space->mesh();
      EXPECT_EQ(a.faces, b.faces);
      EXPECT_TRUE(std::ranges::equal(from.space->link_codes(), to.space->link_codes()));
      for (KnotIndex k = 0; k < a.knots.size(); ++k) {
        if (a.knots[k].kind == KnotKind::kVertex) {
          EXPECT_EQ(a.knots[k].position, b.knots[k].position);
        }
      }
    }
  }
}

/// Knots that are where the picture has them: every step leads away, and none of them is kept.
TEST_P(Descent, StepsThatRaiseTheErrorAreNotKept) {
  const ColourFitOptions options{.ridge = 1e-11, .smooth_corners = false};
  const auto space = make_space(featured_mesh(2), GetParam());
  const std::vector<double> control = random_control(space->function_count(), 3);
  const image::Image image =
      picture_of(slow_surface(spline::Basis(space), control, 1, 48, 40, {}), 48, 40, 1);
  const Pixels pixels{.image = &image};
  ColourSurface from{space, fit_colours(spline::Basis(space), pixels, options)};
  const ColourSurface to = descend(from, pixels, {.steps = 3, .colour = options});
  EXPECT_EQ(to.space, from.space);
  EXPECT_EQ(to.fit.control, from.fit.control);
}

TEST_P(Descent, KnotsGoWhereTheyHelp) {
  const image::Image image = picture(1);
  const Pixels pixels{.image = &image};
  MeshBuilder b(48, 40);
  for (int i = 1; i < 5; ++i) {
    for (int j = 1; j < 4; ++j) b.free(9.6 * i + 0.3 * ((i * j) % 3), 10.0 * j + 0.4 * ((i + j) % 3));
    b.border(9.6 * i, 0);
    b.border(9.6 * i + 0.2, 40);
  }
  const ColourSurface from = start(b.triangulated(), GetParam(), pixels);
  double before = from.fit.squared_error;
  for (const int steps : {1, 4, 12}) {
    const ColourSurface to = descend(from, pixels, {.steps = steps});
    EXPECT_LT(to.fit.squared_error, before) << steps << " steps";
    before = to.fit.squared_error;
  }
  EXPECT_LT(before, 0.6 * from.fit.squared_error);
}

TEST_P(Descent, TheNumberOfThreadsDoesNotMatter) {
  const image::Image image = picture(3);
  const Pixels pixels{.image = &image};
  std::vector<Vec2> positions[2];
  std::vector<double> control[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i + 1);
    const ColourSurface to = descend(start(featured_mesh(2), GetParam(), pixels), pixels, {.steps = 4});
    for (const mesh::Knot& k : to.space->mesh().knots) positions[i].push_back(k.position);
    control[i] = to.fit.control;
  }
  EXPECT_EQ(positions[0], positions[1]);
  EXPECT_EQ(control[0], control[1]);
}

TEST(DescentSteps, AreReportedAndMayStopTheWork) {
  const image::Image image = picture(1);
  const Pixels pixels{.image = &image};
  const ColourSurface from = start(featured_mesh(2), 2, pixels);
  int calls = 0;
  descend(from, pixels, {.steps = 5, .on_step = [&] { ++calls; }});
  EXPECT_EQ(calls, 5);
  calls = 0;
  const auto stop = [&] {
    if (++calls == 3) throw std::runtime_error("stop");
  };
  EXPECT_THROW(descend(from, pixels, {.steps = 5, .on_step = stop}), std::runtime_error);
  EXPECT_EQ(calls, 3);
  const ColourSurface same = descend(from, pixels, {.steps = 0});
  EXPECT_EQ(same.space, from.space);
  EXPECT_EQ(same.fit.control, from.fit.control);
}

TEST(DescentSteps, UseTheOptionsOfTheColourFit) {
  const image::Image image = picture(1);
  const Pixels pixels{.image = &image};
  const ColourFitOptions options{.ridge = 1e-2, .smooth_corners = false};
  const ColourSurface to =
      descend(start(featured_mesh(2), 2, pixels, options), pixels, {.steps = 3, .colour = options});
  EXPECT_LT(most_apart(fit_colours(spline::Basis(to.space), pixels, options).control, to.fit.control), 0.05);
}

/// However long a step that is asked for, it leaves faces of a quarter of the distance, and thinner ones as
/// thick as they were.
TEST(DescentSteps, KeepFacesThick) {
  const image::Image image = picture(1);
  const Pixels pixels{.image = &image};
  const auto height = [](const mesh::KnotMesh& mesh, const mesh::Face& f) {
    const Vec2 a = mesh.knots[f[0]].position;
    const Vec2 b = mesh.knots[f[1]].position;
    const Vec2 c = mesh.knots[f[2]].position;
    return 2 * signed_area(a, b, c) / std::max({norm(b - a), norm(c - b), norm(a - c)});
  };
  ColourSurface at = start(featured_mesh(2), 2, pixels);
  int stopped = 0;  // faces as thin as they may be
  for (int i = 0; i < 8; ++i) {
    // Whatever a long step does, it is the next start: an error beyond all others lets it through.
    at.fit.squared_error = 1e300;
    const ColourSurface next = descend(at, pixels, {.steps = 1, .first_step = 3, .min_distance = 8});
    ASSERT_NE(next.space, at.space);
    for (const mesh::Face& f : at.space->mesh().faces) {
      const double least = std::min(2.0, height(at.space->mesh(), f));
      ASSERT_GE(height(next.space->mesh(), f), least - 1e-9);
      stopped += height(next.space->mesh(), f) < 1.5 * least;
    }
    expect_sound(*next.space);
    at = next;
  }
  EXPECT_GT(stopped, 0) << "the steps were long enough to meet the bounds";
}

TEST(LimitedMoves, WhatIsNoMoveIsNone) {
  const auto space = make_space(featured_mesh(1), 2);
  std::vector<Vec2> moves(space->mesh().knots.size(), Vec2{1e-3, 0});
  moves.back() = {std::numeric_limits<double>::quiet_NaN(), 0};
  moves[moves.size() - 2] = {0, std::numeric_limits<double>::infinity()};
  limit_moves(*space, space->mesh(), 1.0, moves);
  EXPECT_EQ(moves.back(), Vec2{});
  EXPECT_EQ(moves[moves.size() - 2], Vec2{});
  EXPECT_EQ(moves.front(), (Vec2{1e-3, 0})) << "far away";
}

}  // namespace
}  // namespace knotreel::fit
