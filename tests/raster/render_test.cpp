// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/raster/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "raster/feature_trace.h"
#include "raster/surface.h"
#include "support/models.h"

namespace knotreel::raster {
namespace {

using document::FrameModel;
using knotreel::testing::MeshBuilder;
using knotreel::testing::MeshCase;

constexpr std::uint64_t kRenderSeed = 20260404;

/// Meshes small enough for the reference, which is slow, with features of every kind.
std::vector<MeshCase> small_cases() {
  std::vector<MeshCase> cases = knotreel::testing::corpus_cases();
  std::erase_if(
      cases, [](const MeshCase& c) { return c.name.ends_with("-mirrored") || c.name.ends_with("-turned"); });
  return knotreel::testing::fewer_if_checked(std::move(cases));
}

/// How far control points may be displaced at random, in pixels: not at all with knots a hundredth of a pixel
/// apart, where the map would not be one to one.
double displacement_reach(const MeshCase& c) {
  return c.name == "knots-squeezed-on-feature" ? 0 : 2;
}

/// Distance of a pixel's centre from the nearest feature curve, in output pixels.
double feature_distance(const FeatureTrace& trace, double scale, int x, int y) {
  return trace.distance({(x + 0.5) / scale, (y + 0.5) / scale}, 64) * scale;
}

RenderOptions at_scale(const FrameModel& model, double scale) {
  RenderOptions o;
  o.width = static_cast<int>(std::lround(model.space->mesh().width * scale));
  o.height = static_cast<int>(std::lround(model.space->mesh().height * scale));
  return o;
}

TEST(Render, PixelsOffTheFeaturesEqualTheReferenceAndCoverageIsRight) {
  for (const MeshCase& c : small_cases()) {
    SCOPED_TRACE(c.name);
    for (const int degree : {1, 2, 3}) {
      FrameModel model = knotreel::testing::blank_model(c.mesh, degree, 3);
      knotreel::testing::displace_randomly(model, displacement_reach(c), kRenderSeed);
      knotreel::testing::colour_randomly(model, kRenderSeed);
      const FeatureTrace trace(Surface(model), c.mesh);
      for (const double scale : {1.0, 4.0}) {
        if (degree == 3 && scale == 1.0) continue;  // the reference is slow
        RenderOptions options = at_scale(model, scale);
        // A window in the middle, where the features are.
        options.crop_width = 8;
        options.crop_height = 6;
        options.crop_x = options.width / 2 - 4;
        options.crop_y = options.height / 2 - 3;
        const std::vector<float> fast = render(model, options);
        const std::vector<float> slow = render_reference(model, options);
        for (int i = 0; i < 48; ++i) {
          const int x = options.crop_x + i % 8;
          const int y = options.crop_y + i / 8;
          const bool off = feature_distance(trace, scale, x, y) > 0.75;
          for (std::size_t k = 0; k < 3; ++k) {
            const auto s = static_cast<std::size_t>(i) * 3 + k;
            EXPECT_NEAR(fast[s], slow[s], off ? 0.01 : 255.0 / 16)
                << "pixel " << x << ' ' << y << " scale " << scale << " degree " << degree;
          }
        }
      }
    }
  }
}

/// If the colour of each control point is its own position, the picture shows the positions of its pixels,
/// whatever the displacement: an exact test of the inversion, everywhere, features included.
TEST(Render, ColourEqualToPositionComesOutAsPosition) {
  std::vector<MeshCase> cases = small_cases();
  for (MeshCase& c : knotreel::testing::fewer_if_checked(knotreel::testing::random_cases(kRenderSeed, 10)))
    cases.push_back(std::move(c));
  for (const MeshCase& c : cases) {
    SCOPED_TRACE(c.name);
    for (const int degree : {1, 2, 3}) {
      FrameModel model = knotreel::testing::blank_model(c.mesh, degree, 2);
      model.channels = 3;
      model.colour.assign(model.space->function_count() * 3, 0.0);
      knotreel::testing::displace_randomly(model, displacement_reach(c), kRenderSeed + 1);
      for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
        const Vec2 p = model.space->greville(f) + model.displacement[model.space->geometry_of()[f]];
        model.colour[3 * f] = p.x;
        model.colour[3 * f + 1] = p.y;
      }
      for (const double scale : {0.5, 1.0, 3.3}) {
        if (degree != 2 && scale != 1.0) continue;
        const RenderOptions options = at_scale(model, scale);
        const std::vector<float> out = render(model, options);
        double worst = 0;
        for (int y = 0; y < options.height; ++y) {
          for (int x = 0; x < options.width; ++x) {
            const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                                static_cast<std::size_t>(x));
            const double px = (x + 0.5) * c.mesh.width / options.width;
            const double py = (y + 0.5) * c.mesh.height / options.height;
            const double error = std::hypot(out[i] - px, out[i + 1] - py);
            if (!(error <= worst)) worst = error;
          }
        }
        EXPECT_LE(worst, 0.01) << "scale " << scale << " degree " << degree << '\n' << c.to_text();
      }
    }
  }
}

/// A closed loop and a line from border to border: every side has a colour of its own.
FrameModel two_coloured_model(int degree, std::uint64_t seed) {
  MeshBuilder b(60, 50);
  b.free(10, 12);
  b.free(48, 9);
  b.free(30, 24);
  b.free(28, 44);
  b.free(8, 30);
  const auto v0 = b.vertex(18, 15);
  const auto v1 = b.vertex(44, 17);
  const auto v2 = b.vertex(39, 36);
  const auto v3 = b.vertex(20, 34);
  b.segment(v0, v1, 2);
  b.segment(v1, v2, 1);
  b.segment(v2, v3, 2);
  b.segment(v3, v0, 1);
  FrameModel model = knotreel::testing::blank_model(b.triangulated(), degree, 1);
  knotreel::testing::displace_randomly(model, 2.5, seed);
  // Inside: functions all of whose knots are inside corners, which only the free knot 30,24 and the loop's
  // inner corners are; flood over the cut mesh from that knot.
  const auto& cut = model.space->cut();
  std::vector<bool> inside(cut.corners.size(), false);
  for (std::size_t c = 0; c < inside.size(); ++c) {
    inside[c] = cut.corners[c].knot == 6;  // four domain corners, then free knots; 30,24 is the third
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& face : cut.faces) {
      const bool any = inside[face[0]] || inside[face[1]] || inside[face[2]];
      for (const auto c : face) {
        grown = grown || (any && !inside[c]);
        if (any) inside[c] = true;
      }
    }
  }
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    model.colour[f] = inside[model.space->functions()[f].knots[0]] ? 200 : 50;
  }
  return model;
}

TEST(Render, NoCrackOrFringeAtAnyScale) {
  for (const int degree : {1, 2, 3}) {
    const FrameModel model = two_coloured_model(degree, kRenderSeed + 2);
    const FeatureTrace trace(Surface(model), model.space->mesh());
    for (const double scale : {1.0, 4.0, 16.0}) {
      RenderOptions options = at_scale(model, scale);
      const std::vector<float> out = render(model, options);
      int inner = 0;
      for (int y = 0; y < options.height; ++y) {
        for (int x = 0; x < options.width; ++x) {
          const float v = out[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                              static_cast<std::size_t>(x)];
          inner += v > 199;
          const bool pure = std::abs(v - 50) < 0.01 || std::abs(v - 200) < 0.01;
          ASSERT_TRUE(v > 49.99 && v < 200.01) << "fringe at " << x << ' ' << y << " scale " << scale;
          if (!pure) {
            ASSERT_LT(feature_distance(trace, scale, x, y), 0.75)
                << "crack at " << x << ' ' << y << ", " << v;
          }
        }
      }
      EXPECT_GT(inner, 0.1 * options.width * options.height);
    }
  }
}

TEST(Render, CoverageIsExactToASixteenth) {
  for (const int degree : {1, 2, 3}) {
    const FrameModel model = two_coloured_model(degree, kRenderSeed + 3);
    for (const double scale : {1.0, 4.0, 16.0}) {
      // Coverage by a picture drawn so much larger that its own edges do not matter.
      const int k = scale > 4 ? 4 : 8;
      RenderOptions options = at_scale(model, scale);
      const std::vector<float> out = render(model, options);
      RenderOptions large = at_scale(model, scale * k);
      double worst = 0;
      const Renderer renderer(model, large);
      std::vector<float> band(static_cast<std::size_t>(large.width) * static_cast<std::size_t>(k));
      for (int y = 0; y<options.height; y += scale> 4 ? 37 : 3) {
        renderer.rows(y * k, (y + 1) * k, band);
        for (int x = 0; x < options.width; ++x) {
          double sum = 0;
          for (int i = 0; i < k * k; ++i) {
            sum += band[static_cast<std::size_t>(i / k) * static_cast<std::size_t>(large.width) +
                        static_cast<std::size_t>(x * k + i % k)];
          }
          const float v = out[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                              static_cast<std::size_t>(x)];
          worst = std::max(worst, std::abs(v - sum / (k * k)) / 150);
        }
      }
      EXPECT_LE(worst, 1.0 / 16) << "scale " << scale << " degree " << degree;
    }
  }
}

FrameModel busy_model() {
  const std::vector<MeshCase> cases = knotreel::testing::random_cases(kRenderSeed + 5, 30);
  const auto busiest = std::max_element(cases.begin(), cases.end(), [](const MeshCase& a, const MeshCase& b) {
    return a.mesh.segments.size() < b.mesh.segments.size();
  });
  FrameModel model = knotreel::testing::blank_model(busiest->mesh, 2, 4);
  knotreel::testing::displace_randomly(model, 2, kRenderSeed);
  knotreel::testing::colour_randomly(model, kRenderSeed);
  return model;
}

TEST(Render, SameBitsForAnyThreadCountBandAndCrop) {
  FrameModel model = busy_model();
  model.edge_softness = 0.1;
  for (const double scale : {0.4, 1.0, 2.7, 6.0}) {
    const RenderOptions options = at_scale(model, scale);
    std::vector<float> whole;
    {
      const ThreadCap one(1);
      whole = render(model, options);
    }
    const ThreadCap four(4);
    EXPECT_EQ(whole, render(model, options));

    const Renderer renderer(model, options);
    std::vector<float> bands;
    for (int y = 0; y < options.height;) {
      const int n = std::min(1 + y % 5, options.height - y);
      std::vector<float> band(static_cast<std::size_t>(n * options.width) * 4);
      renderer.rows(y, y + n, band);
      bands.insert(bands.end(), band.begin(), band.end());
      y += n;
    }
    EXPECT_EQ(whole, bands);

    RenderOptions crop = options;
    crop.crop_x = 7;
    crop.crop_y = 5;
    crop.crop_width = 11;
    crop.crop_height = 13;
    const std::vector<float> part = render(model, crop);
    for (int y = 0; y < 13; ++y) {
      const auto* from =
          whole.data() + (static_cast<std::size_t>(y + 5) * static_cast<std::size_t>(options.width) + 7) * 4;
      EXPECT_TRUE(std::equal(from, from + 44, part.data() + static_cast<std::size_t>(y) * 44)) << scale;
    }
  }
}

TEST(Render, SomeTilesEqualTheWhole) {
  FrameModel model = busy_model();
  model.edge_softness = 0.1;
  const auto basis = std::make_shared<const spline::Basis>(model.space);
  const image::Image whole = Renderer(model, {}, basis).whole();
  const int columns = (whole.width + 7) / 8;
  const auto count = static_cast<std::size_t>(columns * ((whole.height + 7) / 8));
  std::mt19937 random(kRenderSeed);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::uint8_t> tiles(count);
    for (std::uint8_t& tile : tiles) tile = random() % 6 == 0 ? 1 : 0;
    const image::Image some = Renderer::in_tiles(model, basis, nullptr, tiles);
    for (int y = 0; y < whole.height; ++y) {
      for (int x = 0; x < whole.width; ++x) {
        if (!tiles[static_cast<std::size_t>(y / 8 * columns + x / 8)]) continue;
        for (int c = 0; c < whole.channels; ++c)
          ASSERT_EQ(some.at(x, y, c), whole.at(x, y, c)) << x << ' ' << y << ", round " << round;
      }
    }
  }
}

/// Dense tiles start from a small box and fall back to a larger one if a point leaves it: that must not show
/// in the points that come after, or the picture would depend on the rows asked for.
TEST(Render, RowsAloneEqualTheWholeWhereTilesFallBack) {
  std::vector<MeshCase> cases = knotreel::testing::corpus_cases();
  std::erase_if(cases, [](const MeshCase& c) { return c.name != "feature-close-to-border"; });
  ASSERT_EQ(cases.size(), 1u);
  FrameModel model = knotreel::testing::blank_model(cases[0].mesh, 2, 3);
  knotreel::testing::displace_randomly(model, 8, 78);
  knotreel::testing::colour_randomly(model, 5);
  for (const double scale : {3.0, 5.0}) {
    const RenderOptions options = at_scale(model, scale);
    const Renderer renderer(model, options);
    const std::vector<float> whole = render(model, options);
    std::vector<float> row(static_cast<std::size_t>(options.width) * 3);
    for (int y = 0; y < options.height; ++y) {
      renderer.rows(y, y + 1, row);
      EXPECT_TRUE(std::equal(row.begin(), row.end(), whole.begin() + y * std::ssize(row)))
          << scale << ' ' << y;
    }
  }
}

TEST(Render, SmallerPicturesAreMeansOfLargerOnes) {
  FrameModel model = two_coloured_model(2, kRenderSeed);
  model.edge_softness = 0.1;
  const std::vector<float> full = render(model, at_scale(model, 1));
  const std::vector<float> half = render(model, at_scale(model, 0.5));
  for (int y = 0; y < 25; ++y) {
    for (int x = 0; x < 30; ++x) {
      const auto at = [&](int i, int j) {
        return full[static_cast<std::size_t>(j) * 60 + static_cast<std::size_t>(i)];
      };
      const float mean =
          (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1)) / 4;
      EXPECT_NEAR(half[static_cast<std::size_t>(y) * 30 + static_cast<std::size_t>(x)], mean, 1e-3);
    }
  }
}

TEST(Surface, DisplacementBoundsHoldForEveryParameterOfAnImagePoint) {
  for (const MeshCase& c : knotreel::testing::random_cases(kRenderSeed + 6, 10)) {
    FrameModel model = knotreel::testing::blank_model(c.mesh, 2, 1);
    // Far, so that the parameter and its image lie in cells with different bounds.
    const std::vector<Vec2> sites = model.space->geometry_greville();
    for (std::size_t g = 0; g < sites.size(); ++g) {
      model.displacement[g] = {0.2 * c.mesh.width * std::sin(3.14 * sites[g].x / c.mesh.width),
                               0.05 * sites[g].y};
    }
    const Surface surface(model);
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kRenderSeed, 500)) {
      const Vec2 d = surface.evaluate(u).displacement;
      const Surface::Bounds b = surface.displacement_bounds(u + d, u + d);
      EXPECT_GE(d.x, b.low.x - 1e-9) << c.to_text();
      EXPECT_GE(d.y, b.low.y - 1e-9) << c.to_text();
      EXPECT_LE(d.x, b.high.x + 1e-9) << c.to_text();
      EXPECT_LE(d.y, b.high.y + 1e-9) << c.to_text();
    }
  }
}

TEST(Render, RefusesSizesAndCropsThatMakeNoSense) {
  const FrameModel model = two_coloured_model(2, kRenderSeed);
  for (const RenderOptions& bad : {RenderOptions{.width = -1}, RenderOptions{.width = 1 << 25},
                                   RenderOptions{.crop_x = 60}, RenderOptions{.crop_x = 50, .crop_width = 11},
                                   RenderOptions{.crop_y = -1}, RenderOptions{.crop_height = -4}}) {
    EXPECT_THROW(Renderer(model, bad), Error);
  }
  const Renderer renderer(model);
  std::vector<float> row(60);
  EXPECT_THROW(renderer.rows(49, 51, row), Error);
  EXPECT_THROW(renderer.rows(-1, 0, row), Error);
}

TEST(Render, RefusesASurfaceAtOtherPixels) {
  const FrameModel model = two_coloured_model(2, kRenderSeed);
  const auto basis = std::make_shared<const spline::Basis>(model.space);
  const auto known = [&](std::size_t pixels) {
    return std::make_shared<const spline::PixelSurface>(
        spline::PixelSurface{basis, std::vector<float>(pixels * static_cast<std::size_t>(model.channels))});
  };
  EXPECT_NO_THROW(Renderer(model, {}, basis, known(60 * 50)));
  EXPECT_THROW(Renderer(model, {}, basis, known(60 * 49)), Error);
}

TEST(Render, RefusesModelsThatAreNoSurface) {
  const FrameModel sound = two_coloured_model(2, kRenderSeed);
  const auto refuses = [&](auto change) {
    FrameModel model = sound;
    change(model);
    try {
      Renderer(model).whole();
    } catch (const Error& e) {
      return e.kind() == ErrorKind::kInvalidArgument;
    }
    return false;
  };
  EXPECT_FALSE(refuses([](FrameModel&) {}));
  EXPECT_TRUE(refuses([](FrameModel& m) { m = FrameModel{}; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.colour.clear(); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.displacement.pop_back(); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.channels = 9; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.edge_softness = 1; }));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
    EXPECT_TRUE(refuses([&](FrameModel& m) { m.colour[3] = bad; })) << bad;
    EXPECT_TRUE(refuses([&](FrameModel& m) { m.displacement[3].y = bad; })) << bad;
  }
  // Nonsense that documents may hold is drawn somehow.
  for (const double large : {1e4, 1e8, -0x1p40}) {
    EXPECT_FALSE(refuses([&](FrameModel& m) { m.colour[3] = large; })) << large;
    EXPECT_FALSE(refuses([&](FrameModel& m) { m.displacement[3].y = large; })) << large;
  }
}

}  // namespace
}  // namespace knotreel::raster
