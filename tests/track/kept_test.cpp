// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/kept.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "knotreel/spline/fingerprint.h"
#include "support/mesh_cases.h"
#include "support/models.h"
#include "support/pictures.h"

namespace knotreel::track {
namespace {

using spline::FunctionIndex;

constexpr int kKeptWidth = 96;
constexpr int kKeptHeight = 80;

/// A warm frame as it is fitted: all but its ages.
FittedFrame frame_of(std::shared_ptr<const spline::SplineSpace> space, std::vector<Vec2> displacement,
                     const image::Image& picture, std::vector<double> control,
                     const fit::KnownPlaces& known = {}) {
  FittedFrame frame;
  frame.space = std::move(space);
  frame.displacement = std::move(displacement);
  frame.basis = std::make_shared<const spline::Basis>(frame.space);
  frame.prints = spline::function_fingerprints(*frame.basis);
  frame.seen = place_pixels(frame.basis, frame.displacement, picture, 0, known);
  frame.colours.control = std::move(control);
  frame.surface = surface_at(frame.seen, frame.colours.control);
  return frame;
}

/// A feature, and knots around it on a grid.
mesh::KnotMesh grid_mesh() {
  testing::MeshBuilder b(kKeptWidth, kKeptHeight);
  b.segment(b.vertex(30.3, 40.2), b.vertex(62.1, 44.7), 2);
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 6; ++i) {
      const Vec2 p{8.1 + 16 * i + 0.3 * j, 7.9 + 16 * j + 0.2 * i};
      if (p.x > 24 && p.x < 68 && p.y > 36 && p.y < 48) continue;
      b.free(p.x, p.y);
    }
  }
  return b.triangulated();
}

void expect_near(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-3) << i;
}

class KeptParts : public ::testing::Test {
 protected:
  KeptParts() {
    model_ = testing::blank_model(grid_mesh(), 2, 3);
    testing::displace_randomly(model_, 0.3, 4);
    const std::vector<Vec2> sites = model_.space->geometry_greville();
    for (std::size_t g = 0; g < sites.size(); ++g) {
      if (mesh::on_side(model_.space->mesh(), sites[g])) model_.displacement[g] = {};
    }
    std::mt19937_64 random(6);
    control_.resize(3 * model_.space->function_count());
    for (double& c : control_) c = static_cast<double>(random() % 256);
    before_ = frame_of(model_.space, model_.displacement, picture_, control_);
    before_.ages.assign(model_.space->function_count(), 3);
    match_.resize(model_.space->function_count());
    std::iota(match_.begin(), match_.end(), 0U);
  }

  /// Functions that reach the tile of a pixel.
  std::vector<std::uint8_t> functions_at(int x, int y) const {
    std::vector<std::uint8_t> result(match_.size(), 0);
    const std::size_t tile = std::size_t(y / 8) * before_.values().tile_columns() + std::size_t(x / 8);
    for (const FunctionIndex f : before_.values().functions(tile)) result[f] = 1;
    return result;
  }

  image::Image picture_ = test::random_picture(kKeptWidth, kKeptHeight, 3, 5);
  document::FrameModel model_;
  std::vector<double> control_;
  FittedFrame before_;
  std::vector<std::uint32_t> match_;
};

TEST_F(KeptParts, AllAreWhereNothingIsDifferent) {
  FittedFrame frame = frame_of(model_.space, model_.displacement, picture_, control_);
  Kept kept(before_, frame, match_);
  for (const fit::PlacesOfTile t : kept.places().tiles) EXPECT_EQ(t, fit::PlacesOfTile::kAllKnown);
  for (const std::uint8_t f : kept.places().functions) EXPECT_EQ(f, 0);
  frame = frame_of(model_.space, model_.displacement, picture_, control_, kept.places());
  EXPECT_TRUE(std::ranges::equal(frame.seen.placed->places(), before_.seen.placed->places()));
  kept.see();
  EXPECT_EQ(kept.ages(), std::vector<std::uint8_t>(match_.size(), 4));
  const std::vector<std::uint8_t> surface = kept.surface(control_);
  EXPECT_EQ(std::ranges::count(surface, 0), 0);
  EXPECT_EQ(surface_at(frame.seen, control_, surface, before_.surface.get())->colours,
            before_.surface->colours);
}

TEST_F(KeptParts, FunctionsAreYoungWhereAPixelChanges) {
  for (const auto& [x, y] : {std::pair{10, 10}, std::pair{50, 42}, std::pair{95, 79}}) {
    image::Image picture = picture_;
    picture.at(x, y, 1) += 1;
    const FittedFrame frame = frame_of(model_.space, model_.displacement, picture, control_);
    Kept kept(before_, frame, match_);
    kept.see();
    const std::vector<std::uint8_t> ages = kept.ages();
    const std::vector<std::uint8_t> there = functions_at(x, y);
    // Beside features, pixels have the colour of others.
    for (FunctionIndex f = 0; f < ages.size(); ++f) {
      if (there[f]) {
        EXPECT_EQ(ages[f], 0) << f;
      }
    }
    EXPECT_GT(std::ranges::count(ages, 4), std::ptrdiff_t(ages.size() / 2));
  }
}

TEST_F(KeptParts, AFitLessIsAskedForWhereOnlyAFunctionChanges) {
  FittedFrame frame = frame_of(model_.space, model_.displacement, picture_, control_);
  constexpr FunctionIndex kChanged = 20;
  frame.prints[kChanged] ^= 1;
  Kept kept(before_, frame, match_);
  kept.see();
  std::vector<std::uint8_t> expected(match_.size(), 4);
  for (std::size_t t = 0; t < frame.values().tile_count(); ++t) {
    const auto here = frame.values().functions(t);
    if (std::ranges::find(here, kChanged) == here.end()) continue;
    for (const FunctionIndex f : here) expected[f] = 1;
  }
  EXPECT_EQ(kept.ages(), expected);
  EXPECT_GT(std::ranges::count(expected, 4), std::ptrdiff_t(expected.size() / 4));
}

TEST_F(KeptParts, TheSurfaceIsNewWhereAColourIs) {
  const FittedFrame frame = frame_of(model_.space, model_.displacement, picture_, control_);
  Kept kept(before_, frame, match_);
  kept.see();
  for (FunctionIndex f = 0; f < match_.size(); f += 7) {
    std::vector<double> control = control_;
    control[3 * f + 2] += 3;
    const std::vector<std::uint8_t> surface = kept.surface(control);
    for (std::size_t t = 0; t < surface.size(); ++t) {
      const auto here = frame.values().functions(t);
      EXPECT_EQ(surface[t], std::ranges::find(here, f) == here.end() ? 1 : 0) << t;
    }
    EXPECT_EQ(surface_at(frame.seen, control, surface, before_.surface.get())->colours,
              surface_at(frame.seen, control)->colours);
  }
}

TEST_F(KeptParts, PlacesAreLookedForWhereADisplacementChanges) {
  std::vector<Vec2> displacement = model_.displacement;
  const std::vector<Vec2> sites = model_.space->geometry_greville();
  const auto near = [&](std::size_t g) { return norm(sites[g] - Vec2{46, 42}); };
  std::size_t changed = 0;
  for (std::size_t g = 0; g < sites.size(); ++g) changed = near(g) < near(changed) ? g : changed;
  displacement[changed] = displacement[changed] + Vec2{0.5, 0.25};
  FittedFrame frame;
  frame.space = model_.space;
  frame.displacement = displacement;
  frame.prints = before_.prints;
  const Kept kept(before_, frame, match_);
  const fit::KnownPlaces places = kept.places();
  EXPECT_GT(std::ranges::count(places.tiles, fit::PlacesOfTile::kAllKnown), 0);
  for (std::size_t t = 0; t < places.tiles.size(); ++t) {
    const auto here = before_.values().functions(t);
    const bool has_it =
        std::ranges::any_of(here, [&](FunctionIndex f) { return model_.space->geometry_of()[f] == changed; });
    EXPECT_EQ(places.tiles[t] == fit::PlacesOfTile::kUnknown, has_it) << t;
  }
  const FittedFrame again = frame_of(model_.space, displacement, picture_, control_, places);
  const FittedFrame anew = frame_of(model_.space, displacement, picture_, control_);
  for (std::size_t i = 0; i < anew.seen.placed->places().size(); ++i)
    EXPECT_LT(norm(again.seen.placed->places()[i] - anew.seen.placed->places()[i]), 6e-3) << i;

  Kept at_places(before_, again, match_);
  at_places.see();
  const std::vector<std::uint8_t> surface = at_places.surface(control_);
  EXPECT_GT(std::ranges::count(surface, 1), 0);
  expect_near(surface_at(again.seen, control_, surface, before_.surface.get())->colours,
              again.surface->colours);
}

TEST_F(KeptParts, NothingIsKeptBesideAKnotThatMoved) {
  std::vector<Vec2> positions;
  mesh::KnotIndex moved = 0;
  for (const mesh::Knot& k : model_.space->mesh().knots) {
    if (k.kind == mesh::KnotKind::kFree && k.position.x < 20) moved = mesh::KnotIndex(positions.size());
    positions.push_back(k.position);
  }
  positions[moved] = positions[moved] + Vec2{0.5, 0.5};
  const auto space = std::make_shared<const spline::SplineSpace>(model_.space->moved(positions));
  const FittedFrame frame = frame_of(space, model_.displacement, picture_, control_);
  Kept kept(before_, frame, match_);
  kept.see();
  const std::vector<std::uint8_t> surface = kept.surface(control_);
  EXPECT_GT(std::ranges::count(surface, 0), 0);
  EXPECT_GT(std::ranges::count(surface, 1), 0);
  expect_near(surface_at(frame.seen, control_, surface, before_.surface.get())->colours,
              frame.surface->colours);
}

TEST_F(KeptParts, NothingIsKnownWithoutFingerprints) {
  before_.prints.clear();
  const FittedFrame frame = frame_of(model_.space, model_.displacement, picture_, control_);
  Kept kept(before_, frame, match_);
  EXPECT_TRUE(kept.places().tiles.empty());
  kept.see();
  EXPECT_EQ(kept.ages(), std::vector<std::uint8_t>(match_.size(), 0));
  EXPECT_TRUE(kept.surface(control_).empty());
}

}  // namespace
}  // namespace knotreel::track
