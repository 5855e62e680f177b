// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/colour_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>

#include "fit/fit_cases.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/smooth_corners.h"
#include "knotreel/spline/surface.h"
#include "support/dense.h"
#include "support/pictures.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;
using spline::PixelTiles;
using spline::PixelValues;
using spline::surface_at_pixels;

/// Pixels at their centres or displaced, all of weight 1 or not.
struct ColourCase {
  int degree;
  bool displaced;
  bool weighted;
};

std::ostream& operator<<(std::ostream& out, const ColourCase& c) {
  return out << "degree " << c.degree << (c.displaced ? ", displaced" : "")
             << (c.weighted ? ", weighted" : "");
}

class ColourFits : public ::testing::TestWithParam<ColourCase> {
 protected:
  void SetUp() override {
    if (GetParam().displaced) places_ = scattered_places(48, 40, 1.5, 7);
    if (GetParam().weighted) weights_ = random_weights(48 * 40, 8);
  }

  Pixels pixels(const image::Image& image) const { return {&image, weights_, places_}; }
  double weight(std::size_t pixel) const {
    return weights_.empty() ? 1 : static_cast<double>(weights_[pixel]);
  }
  std::vector<double> surface(const ColourFit& fit, int channels) const {
    return slow_surface(basis_, fit.control, channels, 48, 40, places_);
  }

  std::shared_ptr<const spline::SplineSpace> space_ = make_space(featured_mesh(1), GetParam().degree);
  spline::Basis basis_{space_};
  std::vector<Vec2> places_;
  std::vector<float> weights_;
};

INSTANTIATE_TEST_SUITE_P(All, ColourFits,
                         ::testing::Values(ColourCase{1, false, false}, ColourCase{1, true, true},
                                           ColourCase{2, false, false}, ColourCase{2, false, true},
                                           ColourCase{2, true, false}, ColourCase{2, true, true},
                                           ColourCase{3, false, false}, ColourCase{3, true, true}));

TEST_P(ColourFits, SurfacesOfTheSpaceComeBack) {
  const std::vector<double> control = random_control(3 * space_->function_count(), 3);
  const image::Image image = picture_of(slow_surface(basis_, control, 3, 48, 40, places_), 48, 40, 3);
  const ColourFit fit = fit_colours(basis_, pixels(image), {.ridge = 1e-11, .smooth_corners = false});
  for (std::size_t i = 0; i < fit.residual.size(); ++i) {
    if (weight(i / 3) == 0) continue;
    ASSERT_NEAR(fit.residual[i], 0, 1e-3) << i;
  }
  EXPECT_LT(fit.squared_error, 1e-3);
}

TEST_P(ColourFits, ResidualAndErrorAreThoseOfTheSurface) {
  for (const int channels : {1, 2, 3, 4}) {
    const image::Image image = test::random_picture(48, 40, channels, 5);
    const ColourFit fit = fit_colours(basis_, pixels(image));
    const std::vector<double> expected = surface(fit, channels);
    double error = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double d = static_cast<double>(image.samples[i]) - expected[i];
      ASSERT_NEAR(fit.residual[i], d, 1e-4) << i;
      error += weight(i / std::size_t(channels)) * d * d;
    }
    EXPECT_NEAR(fit.squared_error, error, 1e-8 * error);
  }
}

/// The normal equations, with a dense matrix and weights that are not whole.
TEST_P(ColourFits, NoSurfaceIsBetter) {
  if (!weights_.empty()) weights_[3] = 2.5F;
  const image::Image image = test::random_picture(48, 40, 2, 5);
  const auto n = static_cast<Eigen::Index>(space_->function_count());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(48 * 40, n);
  Eigen::MatrixXd b(48 * 40, 2);
  Eigen::VectorXd w(48 * 40);
  std::vector<spline::BasisValue> values;
  for (std::size_t i = 0; i < 48 * 40; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    basis_.evaluate(places_.empty() ? pixel_centre(i, 48) : places_[i], values);
    for (const auto& v : values) a(row, static_cast<Eigen::Index>(v.function)) = v.value;
    w[row] = weight(i);
    b.row(row) << static_cast<double>(image.samples[2 * i]), static_cast<double>(image.samples[2 * i + 1]);
  }
  const Eigen::MatrixXd weighted = (w.asDiagonal() * a).transpose();
  const Eigen::MatrixXd matrix = testing::product(weighted, a);
  const Eigen::MatrixXd right = testing::product(weighted, b);
  Eigen::MatrixXd prior(n, 2);
  for (Eigen::Index f = 0; f < n; ++f) {
    const Vec2 site = space_->greville(static_cast<spline::FunctionIndex>(f));
    const int x = std::min(47, static_cast<int>(site.x));
    const int y = std::min(39, static_cast<int>(site.y));
    for (int c = 0; c < 2; ++c) prior(f, c) = static_cast<double>(image.at(x, y, c));
  }
  for (const bool smooth : {false, true}) {
    const ColourFitOptions options{.ridge = 1e-3, .smooth_corners = smooth};
    const ColourFit fit = fit_colours(basis_, pixels(image), options);
    const Eigen::MatrixXd c =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            fit.control.data(), n, 2);
    const double ridge = options.ridge * std::max(1.0, matrix.diagonal().maxCoeff());
    Eigen::MatrixXd gradient = testing::product(matrix, c) - right + ridge * (c - prior);
    if (smooth) {
      const Eigen::SparseMatrix<double> p =
          spline::smooth_corner_prolongation(*space_, spline::SharedFunctions::kFree);
      const Eigen::MatrixXd parameters = p.transpose() * c;
      EXPECT_LE((p * parameters - c).cwiseAbs().maxCoeff(), 1e-8) << "the surface is smooth";
      gradient = (p.transpose() * gradient).eval();
    }
    EXPECT_LE(gradient.cwiseAbs().maxCoeff(), 1e-7) << "smooth corners " << smooth;
  }
}

/// In levels, and on average over the pixels; what no pixel decides may differ more.
TEST_P(ColourFits, SinglePrecisionIsNear) {
  const image::Image image = test::random_picture(48, 40, 3, 5);
  const ColourFit fit = fit_colours(basis_, pixels(image));
  const ColourFit single = fit_colours(basis_, pixels(image), {.precision = Precision::kSingle});
  EXPECT_NEAR(single.squared_error, fit.squared_error, 1e-5 * fit.squared_error);
  double worst = 0;
  for (std::size_t i = 0; i < fit.residual.size(); ++i)
    worst = std::max(worst, static_cast<double>(std::abs(single.residual[i] - fit.residual[i])));
  EXPECT_GT(worst, 0);
  EXPECT_LE(worst, 0.02);
}

TEST_P(ColourFits, AStartNearbyLeadsToTheSameSurface) {
  const image::Image image = test::random_picture(48, 40, 3, 5);
  const ColourFit fit = fit_colours(basis_, pixels(image));
  const std::vector<double> noise = random_control(fit.control.size(), 9);
  std::vector<double> start = fit.control;
  for (std::size_t i = 0; i < start.size(); ++i) start[i] += 0.02 * (noise[i] - 128);
  for (std::size_t f = 0; f < start.size() / 3; f += 7)
    std::fill_n(start.begin() + static_cast<std::ptrdiff_t>(3 * f), 3,
                std::numeric_limits<double>::quiet_NaN());
  const ColourFit found = fit_colours(basis_, pixels(image), {.start = start});
  EXPECT_NE(found.control, fit.control) << "found from elsewhere";
  EXPECT_NEAR(found.squared_error, fit.squared_error, 1e-5 * fit.squared_error);
  for (std::size_t i = 0; i < fit.residual.size(); ++i)
    ASSERT_NEAR(found.residual[i], fit.residual[i], 0.1) << i;
  start.pop_back();
  EXPECT_THROW(fit_colours(basis_, pixels(image), {.start = start}), Error);
}

/// The colours of pixels without weight count only at Greville sites, where the ridge draws to them.
TEST_P(ColourFits, PixelsWithoutWeightDoNotCount) {
  if (!GetParam().weighted) return;
  const image::Image image = test::random_picture(48, 40, 3, 5);
  std::vector<bool> site(48 * 40, false);
  for (spline::FunctionIndex f = 0; f < space_->function_count(); ++f) {
    const Vec2 s = space_->greville(f);
    site[std::min<std::size_t>(39, std::size_t(s.y)) * 48 + std::min<std::size_t>(47, std::size_t(s.x))] =
        true;
  }
  image::Image other = image;
  image::Image all = image;
  int changed = 0;
  for (std::size_t i = 0; i < 3 * weights_.size(); ++i) {
    if (weights_[i / 3] > 0) continue;
    all.samples[i] = 255 - all.samples[i];
    if (site[i / 3]) continue;
    other.samples[i] = 255 - other.samples[i];
    ++changed;
  }
  ASSERT_GT(changed, 300);
  const ColourFit expected = fit_colours(basis_, pixels(image));
  const ColourFit fit = fit_colours(basis_, pixels(other));
  EXPECT_EQ(fit.control, expected.control);
  EXPECT_EQ(fit.squared_error, expected.squared_error);
  // The ridge is weak: hardly any influence where others decide.
  EXPECT_NEAR(fit_colours(basis_, pixels(all)).squared_error, expected.squared_error,
              1e-4 * expected.squared_error);
}

TEST_P(ColourFits, TheNumberOfThreadsDoesNotMatter) {
  const image::Image image = test::random_picture(48, 40, 3, 5);
  ColourFit fits[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i + 1);
    fits[i] = fit_colours(basis_, pixels(image));
  }
  EXPECT_EQ(fits[0].control, fits[1].control);
  EXPECT_EQ(fits[0].residual, fits[1].residual);
  EXPECT_EQ(fits[0].squared_error, fits[1].squared_error);
}

/// Knots closer than pixels: many functions without any pixel fall back to the picture.
TEST(ColourFitOfTinyFaces, StaysNearThePicture) {
  MeshBuilder b(20, 16);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-0.2, 0.2);
  for (int i = 0; i < 12; ++i) b.free(8 + unit(random), 7 + unit(random));
  const mesh::KnotMesh mesh = b.triangulated();
  image::Image image = test::random_picture(20, 16, 3, 5);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    image.samples[i] = 0.1F * image.samples[i] + 8.0F * static_cast<float>(i / 3 % 20);
  }
  for (const int degree : {1, 2, 3}) {
    const auto space = make_space(mesh, degree);
    const spline::Basis basis(space);
    const PixelValues values(basis, 20, 16, {});
    const ColourFit fit = fit_colours(values, {.image = &image}, {.smooth_corners = false});
    // Functions that are not zero at any pixel have exactly the colour of the picture at their site.
    std::vector<double> largest(space->function_count(), 0.0);
    std::vector<spline::BasisValue> at;
    for (std::size_t i = 0; i < 20 * 16; ++i) {
      basis.evaluate(pixel_centre(i, 20), at);
      for (const auto& v : at) largest[v.function] = std::max(largest[v.function], v.value);
    }
    int lost = 0;
    for (spline::FunctionIndex f = 0; f < largest.size(); ++f) {
      const Vec2 s = space->greville(f);
      for (int c = 0; c < 3; ++c) {
        const double control = fit.control[3 * f + std::size_t(c)];
        ASSERT_LT(std::abs(control), 1000) << "degree " << degree;
        if (largest[f] > 0) continue;
        ++lost;
        EXPECT_NEAR(control, static_cast<double>(image.at(std::min(19, int(s.x)), std::min(15, int(s.y)), c)),
                    1e-6);
      }
    }
    EXPECT_GT(lost, 0) << "degree " << degree;
    const ColourFit smooth = fit_colours(values, {.image = &image});
    for (const double c : smooth.control) EXPECT_LT(std::abs(c), 1000);
  }
}

TEST(ColourFitInput, SizesMustAgree) {
  const auto space = make_space(featured_mesh(1), 2);
  const spline::Basis basis(space);
  const image::Image image = test::random_picture(48, 40, 3, 5);
  const std::vector<float> weights(48 * 40 - 1, 1.0F);
  const std::vector<Vec2> places(48 * 40 + 1);
  EXPECT_THROW(fit_colours(basis, {.image = &image, .weights = weights}), Error);
  EXPECT_THROW(fit_colours(basis, {.image = &image, .places = places}), Error);
  // Also where not all control points are looked for, so that only some of the numbers are needed.
  const std::vector<double> start(3 * space->function_count(), 100.0);
  const std::vector<double> reluctance(space->function_count() - 1, 0.5);
  std::vector<std::uint8_t> fixed(space->function_count(), 0);
  fixed.front() = 1;
  EXPECT_THROW(fit_colours(basis, {.image = &image},
                           {.start = start, .step = 2, .reluctance = reluctance, .fixed = fixed}),
               Error);
}

TEST(SurfaceAtPixels, EqualsEvaluationByPoints) {
  const std::vector<Vec2> places = scattered_places(48, 40, 1.5, 7);
  for (const int channels : {1, 2, 3, 4}) {
    const auto space = make_space(featured_mesh(2), 2);
    const spline::Basis basis(space);
    const std::vector<double> control = random_control(space->function_count() * std::size_t(channels), 3);
    std::vector<double> out(48 * 40 * std::size_t(channels), 1e9);  // overwritten
    surface_at_pixels<double>(PixelTiles(basis, 48, 40, places), {control, channels}, out);
    const std::vector<double> expected = slow_surface(basis, control, channels, 48, 40, places);
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], expected[i], 1e-9);
  }
}

/// Fixed at what they would be anyway, they change nothing; and with other starts they stay there.
TEST_P(ColourFits, FixedControlPointsStay) {
  const image::Image image = test::random_picture(48, 40, 3, 5);
  const std::size_t count = space_->function_count();
  const ColourFit free = fit_colours(basis_, pixels(image), {.smooth_corners = false});
  std::mt19937_64 random(11);
  std::vector<std::uint8_t> fixed(count);
  for (std::uint8_t& f : fixed) f = random() % 2;
  ColourFitOptions options{.smooth_corners = false, .start = free.control, .fixed = fixed};
  const ColourFit same = fit_colours(basis_, pixels(image), options);
  for (std::size_t i = 0; i < free.control.size(); ++i) {
    if (fixed[i / 3]) {
      ASSERT_EQ(same.control[i], free.control[i]);
    }
    // The ridge is a share of the largest diagonal, which may be that of a fixed one.
    ASSERT_NEAR(same.control[i], free.control[i], 0.5) << i;
  }
  std::vector<double> start = free.control;
  for (double& v : start) v += static_cast<double>(random() % 64);
  options.start = start;
  options.step = 3;
  const ColourFit other = fit_colours(basis_, pixels(image), options);
  for (std::size_t i = 0; i < start.size(); ++i) {
    ASSERT_EQ(other.control[i], fixed[i / 3] ? start[i] : 3 * std::round(other.control[i] / 3)) << i;
  }
  const std::vector<std::uint8_t> all(count, 1);
  options.fixed = all;
  EXPECT_EQ(fit_colours(basis_, pixels(image), options).control, start);
}

/// What smooths a corner holds, so those that share in it stay or go together.
TEST_P(ColourFits, CornersStaySmoothBesideFixedControlPoints) {
  if (GetParam().degree == 1) return;
  const image::Image image = test::random_picture(48, 40, 1, 5);
  const ColourFit free = fit_colours(basis_, pixels(image));
  const Eigen::SparseMatrix<double> p =
      spline::smooth_corner_prolongation(*space_, spline::SharedFunctions::kFree);
  std::mt19937_64 random(12);
  for (int n = 0; n < 5; ++n) {
    std::vector<std::uint8_t> fixed(space_->function_count());
    for (std::uint8_t& f : fixed) f = random() % 4 > 0;
    const ColourFit some = fit_colours(basis_, pixels(image), {.start = free.control, .fixed = fixed});
    const Eigen::Map<const Eigen::VectorXd> control(some.control.data(), p.rows());
    const Eigen::VectorXd z = testing::least_squares(Eigen::MatrixXd(p), control);
    EXPECT_LT((p * z - control).cwiseAbs().maxCoeff(), 1e-3);
  }
}

TEST_P(ColourFits, FixedControlPointsNeedAStart) {
  const image::Image image = test::random_picture(48, 40, 1, 5);
  const std::vector<std::uint8_t> fixed(space_->function_count(), 1);
  EXPECT_THROW(fit_colours(basis_, pixels(image), {.fixed = fixed}), Error);
  const std::vector<double> start(space_->function_count(), 0.0);
  EXPECT_THROW(fit_colours(basis_, pixels(image), {.start = start, .fixed = std::span(fixed).first(1)}),
               Error);
}

}  // namespace
}  // namespace knotreel::fit
