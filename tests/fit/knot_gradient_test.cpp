// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/knot_gradient.h"

#include <gtest/gtest.h>

#include "fit/fit_cases.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "support/pictures.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;
using mesh::KnotIndex;
using mesh::KnotKind;

struct GradientCase {
  int degree;
  bool displaced;
  bool weighted;
  int channels;
};

std::ostream& operator<<(std::ostream& out, const GradientCase& c) {
  return out << "degree " << c.degree << ", channels " << c.channels << (c.displaced ? ", displaced" : "")
             << (c.weighted ? ", weighted" : "");
}

/// Directions in which a knot may move.
std::vector<Vec2> directions_of(const mesh::KnotMesh& mesh, KnotIndex k) {
  const mesh::Knot& knot = mesh.knots[k];
  if (knot.kind == KnotKind::kFree) return {{1, 0}, {0, 1}};
  if (knot.kind == KnotKind::kBorder) {
    const bool upright = knot.position.x == 0 || knot.position.x == mesh.width;
    return {upright ? Vec2{0, 1} : Vec2{1, 0}};
  }
  for (const auto& s : mesh.segments) {
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      if (s.knots[i] != k) continue;
      const Vec2 along = mesh.knots[s.knots.back()].position - mesh.knots[s.knots.front()].position;
      return {(1 / norm(along)) * along};
    }
  }
  return {};
}

class Gradient : public ::testing::TestWithParam<GradientCase> {
 protected:
  void SetUp() override {
    if (GetParam().displaced) {
      places_ = scattered_places(48, 40, 1.2, 17);
      // Some stay at their centres: those are summed in another way.
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (i % 48 < 20 && i % 5 != 0) places_[i] = {double(i % 48) + 0.5, double(i / 48) + 0.5};
      }
    }
    if (GetParam().weighted) {
      weights_ = random_weights(48 * 40, 18);
      for (std::size_t i = 0; i < weights_.size(); i += 7) weights_[i] *= 1.75F;
    }
    image_ = test::random_picture(48, 40, GetParam().channels, 19);
    for (std::size_t i = 0; i < image_.samples.size(); ++i) {
      // A slope under the noise, so that not all of the residual is noise.
      image_.samples[i] = 0.3F * image_.samples[i] + 3.0F * static_cast<float>(i % 48);
    }
  }

  Pixels pixels() const { return {&image_, weights_, places_}; }
  spline::PixelValues values() const { return {basis_, image_.width, image_.height, places_}; }

  /// Squared error of held control points over the mesh with one knot elsewhere.
  double held_error(const ColourFit& fit, KnotIndex knot, Vec2 offset) const {
    const spline::Basis moved(moved_space(knot, offset));
    const auto n = std::size_t(image_.channels);
    const std::vector<double> s = slow_surface(moved, fit.control, image_.channels, 48, 40, places_);
    double sum = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double d = static_cast<double>(image_.samples[i]) - s[i];
      sum += d * d * (weights_.empty() ? 1.0 : static_cast<double>(weights_[i / n]));
    }
    return sum;
  }

  std::shared_ptr<const spline::SplineSpace> moved_space(KnotIndex knot, Vec2 offset) const {
    std::vector<Vec2> positions;
    for (const mesh::Knot& k : space_->mesh().knots) positions.push_back(k.position);
    positions[knot] = positions[knot] + offset;
    return std::make_shared<const spline::SplineSpace>(space_->moved(positions));
  }

  std::shared_ptr<const spline::SplineSpace> space_ = make_space(featured_mesh(6), GetParam().degree);
  spline::Basis basis_{space_};
  image::Image image_;
  std::vector<Vec2> places_;
  std::vector<float> weights_;
};

INSTANTIATE_TEST_SUITE_P(All, Gradient,
                         ::testing::Values(GradientCase{1, false, false, 1}, GradientCase{2, false, false, 3},
                                           GradientCase{2, true, false, 1}, GradientCase{2, false, true, 4},
                                           GradientCase{2, true, true, 2}, GradientCase{3, false, false, 1},
                                           GradientCase{3, true, true, 3}));

TEST_P(Gradient, IsTheDerivativeWithControlPointsHeld) {
  // A strong ridge, and smooth corners: nothing depends on the control points being the best ones.
  const ColourFit fit = fit_colours(basis_, pixels(), {.ridge = 1e-3});
  const std::vector<Vec2> gradient = knot_gradient(values(), pixels(), fit);
  const mesh::KnotMesh& mesh = space_->mesh();
  ASSERT_EQ(gradient.size(), mesh.knots.size());
  double largest = 0;
  for (const Vec2 g : gradient) largest = std::max(largest, norm(g));
  int seen[4] = {};
  constexpr double kStep = 1e-4;
  for (KnotIndex k = 0; k < gradient.size(); ++k) {
    const std::vector<Vec2> directions = directions_of(mesh, k);
    ++seen[static_cast<int>(mesh.knots[k].kind)];
    if (directions.empty()) {
      EXPECT_EQ(gradient[k], Vec2{}) << "vertex " << k;
      continue;
    }
    Vec2 within;
    for (const Vec2 d : directions) {
      const double expected = (held_error(fit, k, kStep * d) - held_error(fit, k, -kStep * d)) / (2 * kStep);
      EXPECT_NEAR(dot(gradient[k], d), expected, 1e-3 * std::abs(expected) + 1e-4 * largest)
          << "knot " << k << " kind " << static_cast<int>(mesh.knots[k].kind);
      within = within + dot(gradient[k], d) * d;
    }
    EXPECT_LE(norm(gradient[k] - within), 1e-9 * largest) << "knot " << k << " leaves its line";
  }
  for (const int n : seen) EXPECT_GT(n, 2);
}

/// Variable projection: what the control points do in answer is of second order.
TEST_P(Gradient, IsTheDerivativeOfTheBestFit) {
  const ColourFitOptions options{.ridge = 1e-9, .smooth_corners = false};
  const ColourFit fit = fit_colours(basis_, pixels(), options);
  const std::vector<Vec2> gradient = knot_gradient(values(), pixels(), fit);
  double largest = 0;
  for (const Vec2 g : gradient) largest = std::max(largest, norm(g));
  constexpr double kStep = 1e-3;
  const auto error = [&](KnotIndex k, Vec2 offset) {
    return fit_colours(spline::Basis(moved_space(k, offset)), pixels(), options).squared_error;
  };
  for (KnotIndex k = 0; k < gradient.size(); ++k) {
    for (const Vec2 d : directions_of(space_->mesh(), k)) {
      const double expected = (error(k, kStep * d) - error(k, -kStep * d)) / (2 * kStep);
      EXPECT_NEAR(dot(gradient[k], d), expected, 0.01 * std::abs(expected) + 0.002 * largest) << "knot " << k;
    }
  }
}

TEST_P(Gradient, TheNumberOfThreadsDoesNotMatter) {
  const ColourFit fit = fit_colours(basis_, pixels());
  std::vector<Vec2> gradients[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i + 1);
    gradients[i] = knot_gradient(values(), pixels(), fit);
  }
  EXPECT_EQ(gradients[0], gradients[1]);
}

TEST_P(Gradient, OfSomeKnotsIsThatOfAllForThem) {
  const ColourFit fit = fit_colours(basis_, pixels());
  const std::vector<Vec2> all = knot_gradient(values(), pixels(), fit);
  std::vector<std::uint8_t> wanted(all.size());
  for (KnotIndex k = 0; k < all.size(); ++k) wanted[k] = k % 5 == 0;
  const std::vector<Vec2> some = knot_gradient(values(), pixels(), fit, wanted);
  ASSERT_EQ(some.size(), all.size());
  for (KnotIndex k = 0; k < all.size(); ++k) EXPECT_EQ(some[k], wanted[k] ? all[k] : Vec2{}) << "knot " << k;
}

TEST_P(Gradient, NeedsOneFlagPerKnot) {
  const ColourFit fit = fit_colours(basis_, pixels());
  const std::vector<std::uint8_t> wanted(space_->mesh().knots.size() - 1, 1);
  EXPECT_THROW(knot_gradient(values(), pixels(), fit, wanted), Error);
}

/// Whatever the picture, a surface that meets it exactly has nothing to gain.
TEST(GradientOfAnExactFit, IsZero) {
  const auto space = make_space(featured_mesh(6), 2);
  const spline::Basis basis(space);
  ColourFit fit;
  fit.control = random_control(space->function_count(), 3);
  fit.residual.assign(48 * 40, 0.0F);
  const image::Image image = image::make_image(48, 40, 1);
  const spline::PixelValues values(basis, 48, 40, {});
  for (const Vec2 g : knot_gradient(values, {.image = &image}, fit)) EXPECT_EQ(norm(g), 0);
}

}  // namespace
}  // namespace knotreel::fit
