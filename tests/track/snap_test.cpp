// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/snap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "knotreel/mesh/triangulate.h"
#include "knotreel/vectorize/vectorize.h"
#include "track/edge_picture.h"

namespace knotreel::track {
namespace {

/// The surface of the edge at 48.
struct Surface {
  document::FrameModel model = vectorize::vectorize_picture(edge_at(48)).model;
  spline::Basis basis{model.space};
  std::vector<Vec2> still = std::vector<Vec2>(model.space->mesh().knots.size());

  SnapResult snap(const image::Image& before, const image::Image& now) const {
    return snap_to_edges(basis, model.displacement, model.space->mesh(), still, before,
                         motion::luma_of(before), motion::luma_of(now));
  }
};

TEST(Snap, EndsFollowTheEdge) {
  const Surface surface;
  const mesh::KnotMesh& mesh = surface.model.space->mesh();
  ASSERT_FALSE(mesh.segments.empty());
  const Vec2 normal{1 / std::hypot(1.0, 0.3), 0.3 / std::hypot(1.0, 0.3)};
  for (const double far : {-2.0, -1.0, 1.0, 2.0}) {
    const SnapResult snapped = surface.snap(edge_at(48), edge_at(48 + far));
    for (const mesh::FeatureSegment& s : mesh.segments) {
      EXPECT_NEAR(dot(snapped.moves[s.knots.front()], normal), far * normal.x, 0.15 * std::abs(far) + 0.05);
      EXPECT_NEAR(dot(snapped.moves[s.knots.back()], normal), far * normal.x, 0.15 * std::abs(far) + 0.05);
    }
    EXPECT_EQ(std::count(snapped.lost.begin(), snapped.lost.end(), 1), 0) << far;
  }
}

/// An upright edge that is clear above a row, and faint below it.
image::Image fading_edge(double x) {
  image::Image picture = image::make_image(64, 64, 1);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column)
      picture.at(column, row, 0) = float(20 + (row < 16 ? 220 : 14) * std::clamp(column + 1 - x, 0.0, 1.0));
  }
  return picture;
}

TEST(Snap, NoEndGoesFartherThanWhatIsSeen) {
  for (const double length : {6.0, 12.0, 18.0}) {
    mesh::KnotMesh mesh = mesh::make_domain(64, 64);
    const auto add = [&](Vec2 position, mesh::KnotKind kind) {
      const auto index = static_cast<mesh::KnotIndex>(mesh.knots.size());
      mesh.knots.push_back({position, kind, mesh::KnotId{index}});
      return index;
    };
    const mesh::KnotIndex from = add({32, 13.5}, mesh::KnotKind::kVertex);
    const mesh::KnotIndex inside = add({32, 13.5 + length / 2}, mesh::KnotKind::kSegment);
    const mesh::KnotIndex to = add({32, 13.5 + length}, mesh::KnotKind::kVertex);
    mesh.segments.push_back({{from, inside, to}});
    mesh::triangulate(mesh);
    const spline::Basis basis(std::make_shared<const spline::SplineSpace>(mesh, 2));
    const std::vector<Vec2> displacement(basis.space().geometry_count()), still(mesh.knots.size());
    for (const double shift : {0.5, 1.0, 1.5}) {
      const image::Image before = fading_edge(32);
      const SnapResult snapped =
          snap_to_edges(basis, displacement, mesh, still, before, motion::luma_of(before),
                        motion::luma_of(fading_edge(32 + shift)));
      for (const mesh::KnotIndex end : {from, to})
        EXPECT_LT(norm(snapped.moves[end]), 1.1 * shift + 0.05) << length << ", " << shift;
    }
  }
}

TEST(Snap, CurvesWithoutAnEdgeAreLost) {
  const Surface surface;
  const auto all = static_cast<std::ptrdiff_t>(surface.model.space->mesh().segments.size());
  image::Image flat = image::make_image(96, 64, 1);
  std::fill(flat.samples.begin(), flat.samples.end(), 90.0F);
  const SnapResult vanishes = surface.snap(edge_at(48), flat);
  EXPECT_EQ(std::count(vanishes.lost.begin(), vanishes.lost.end(), 1), all);
  // Neither was there an edge before, so that none is missed.
  const SnapResult was_off = surface.snap(edge_at(60), edge_at(60));
  EXPECT_EQ(std::count(was_off.lost.begin(), was_off.lost.end(), 1), all);
}

}  // namespace
}  // namespace knotreel::track
