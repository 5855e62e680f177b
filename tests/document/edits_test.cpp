// SPDX-License-Identifier: GPL-3.0-or-later
// Frames that edit the mesh of the frame before: flips, insertions, removals, moves, other links.

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "document/sample_models.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/writer.h"
#include "support/mesh_edits.h"

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;

constexpr std::uint64_t kEditsSeed = 5150;

/// A frame over another mesh, in one colour: what it takes is its topology and its knots.
FrameModel plain_frame(mesh::KnotMesh mesh, int degree, std::uint64_t seed, bool random_links) {
  FrameModel model = testing::random_model(std::move(mesh), degree, 3, seed, random_links);
  for (Vec2& d : model.displacement) d = {};
  for (double& c : model.colour) c = 0;
  model.pts = 0;
  return model;
}

TEST(Edits, ComeBackBitByBit) {
  for (int degree = 1; degree <= 3; ++degree) {
    for (std::uint64_t seed = kEditsSeed; seed < kEditsSeed + 6; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      mesh::EditableMesh mesh(testing::random_mesh(160, 120, 60, 3, seed));
      testing::MeshEdits edits(mesh, seed);
      std::mt19937_64 random(seed);
      std::ostringstream out;
      FrameModel model = testing::random_model(mesh.to_mesh(), degree, 2, seed, true);
      document::Writer writer(out, testing::info_of(model));
      std::vector<FrameModel> stored;
      for (std::uint64_t frame = 0; frame < 12; ++frame) {
        stored.push_back(writer.append(model));
        for (std::uint64_t n = random() % 40; n > 0; --n) edits.step();
        model = testing::random_model(mesh.to_mesh(), degree, 2, seed + frame, random() % 2 == 0);
        model.frame = frame + 1;
        model.pts = stored.back().pts + 1;
        model.keyframe = random() % 8 == 0;
      }
      writer.finish();
      Reader reader = Reader::open(testing::bytes_of(out));
      ASSERT_EQ(reader.frame_count(), stored.size());
      for (std::size_t f = 0; f < stored.size(); ++f) {
        ASSERT_EQ(testing::difference(reader.read(f), stored[f]), "") << "frame " << f;
      }
    }
  }
}

TEST(Edits, CostWhatTheyChange) {
  // Each of these leaves nearly all of 700 knots as they are.
  const mesh::KnotMesh start = testing::random_mesh(640, 480, 700, 4, kEditsSeed);
  const auto delta_bytes = [&](auto edit) {
    mesh::EditableMesh mesh(start);
    testing::MeshEdits edits(mesh, kEditsSeed);
    std::ostringstream out;
    FrameModel model = plain_frame(start, 2, kEditsSeed, false);
    document::Writer writer(out, testing::info_of(model));
    writer.append(model);
    model.keyframe = false;
    model.edge_softness = 0.125;  // a change, so that it is on the grid of deltas
    model.pts = 1;
    writer.append(model);
    edit(edits);
    model = plain_frame(mesh.to_mesh(), 2, kEditsSeed, false);
    model.keyframe = false;
    model.edge_softness = 0.125;
    model.pts = 2;
    writer.append(model);
    writer.finish();
    Reader reader = Reader::open(testing::bytes_of(out));
    EXPECT_GT(reader.record(0).bytes, 2000u);
    return reader.record(2).bytes;
  };
  EXPECT_LE(delta_bytes([](testing::MeshEdits&) {}), 24u);
  EXPECT_LE(delta_bytes([](testing::MeshEdits& e) { e.insert_in_some_face(); }), 120u);
  EXPECT_LE(delta_bytes([](testing::MeshEdits& e) {
              for (int i = 0; i < 20; ++i) e.flip_some_edge();
            }),
            240u);
}

TEST(Edits, KnotsThatStayAmongMovingOnesCostNoMoreThanMovesByOneStep) {
  // A third of the knots does not go along with the others, which all move alike, to and fro.
  const mesh::KnotMesh start = testing::random_mesh(640, 480, 300, 4, kEditsSeed);
  const auto last_bytes = [&](auto move_of_third) {
    mesh::KnotMesh mesh = start;
    std::ostringstream out;
    FrameModel model = plain_frame(mesh, 2, kEditsSeed, false);
    document::Writer writer(out, testing::info_of(model));
    writer.append(model);
    std::mt19937_64 random(kEditsSeed);
    constexpr std::size_t kFrames = 8;
    for (std::size_t f = 1; f <= kFrames; ++f) {
      mesh::KnotMesh moved = mesh;
      for (std::size_t k = 0; k < moved.knots.size(); ++k) {
        if (moved.knots[k].kind != mesh::KnotKind::kFree) continue;
        const Vec2 move = k % 3 == 0 ? move_of_third(random) : Vec2{0.375, 0.25};
        moved.knots[k].position = moved.knots[k].position + (f % 2 == 0 ? -1.0 : 1.0) * move;
      }
      EXPECT_FALSE(mesh::find_defect(moved)) << f;
      mesh = moved;
      model = plain_frame(mesh, 2, kEditsSeed, false);
      model.keyframe = false;
      model.frame = f;
      model.pts = static_cast<std::int64_t>(f);
      writer.append(model);
    }
    writer.finish();
    return Reader::open(testing::bytes_of(out)).record(kFrames).bytes;
  };
  const auto staying = last_bytes([](std::mt19937_64&) { return Vec2{0, 0}; });
  const auto stepping = last_bytes([](std::mt19937_64& random) {
    const auto step = [&] { return static_cast<double>(random() % 3) / 16 - 1.0 / 16; };
    const double x = step();
    return Vec2{0.375 + x, 0.25 + step()};
  });
  EXPECT_LE(staying, stepping);
}

}  // namespace
}  // namespace knotreel
