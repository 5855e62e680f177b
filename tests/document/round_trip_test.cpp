// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/document/writer.h"
#include "support/mesh_cases.h"

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;
using testing::difference;
using testing::write_document;

constexpr std::uint64_t kRoundTripSeed = 20240607;

std::vector<testing::MeshCase> all_cases() {
  std::vector<testing::MeshCase> cases = testing::corpus_cases();
  for (auto& c : testing::random_cases(kRoundTripSeed, 200)) cases.push_back(std::move(c));
  return testing::fewer_if_checked(std::move(cases));
}

std::vector<std::byte> rewritten(Reader& reader, const document::EncodeOptions& options) {
  std::vector<FrameModel> frames;
  for (std::size_t i = 0; i < reader.frame_count(); ++i) frames.push_back(reader.read(i));
  return write_document(frames, options);
}

TEST(Document, ReadsBackBitByBitWhatAppendReturned) {
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      const FrameModel model =
          testing::random_model(c.mesh, degree, 1 + degree, kRoundTripSeed, degree % 2 == 0);
      std::ostringstream out;
      document::Writer writer(out, testing::info_of(model));
      const FrameModel stored = writer.append(model);
      writer.finish();
      const std::string text = out.str();
      const auto bytes = std::as_bytes(std::span(text));
      Reader reader = Reader::open({bytes.begin(), bytes.end()});
      EXPECT_TRUE(reader.complete());
      EXPECT_EQ(reader.info(), testing::info_of(model));
      ASSERT_EQ(reader.frame_count(), 1u);
      ASSERT_EQ(difference(reader.read(0), stored), "");
    }
  }
}

TEST(Document, AModelOverAStoredMeshIsStoredWithTheSpaceAndTheRoundedGeometryItHas) {
  constexpr int kBits = 5;
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    const document::StoredMesh stored = document::stored_mesh(c.mesh, kBits);
    ASSERT_EQ(mesh::find_defect(stored.mesh), std::nullopt);
    ASSERT_EQ(stored.knot_of.size(), c.mesh.knots.size());
    for (std::size_t k = 0; k < stored.knot_of.size(); ++k) {
      const mesh::Knot& given = c.mesh.knots[stored.knot_of[k]];
      EXPECT_EQ(stored.mesh.knots[k].id, given.id);
      EXPECT_EQ(stored.mesh.knots[k].kind, given.kind);
      EXPECT_LE(norm(stored.mesh.knots[k].position - given.position), std::ldexp(1.5, -kBits));
    }
    for (int degree = 1; degree <= 3; ++degree) {
      FrameModel model = testing::random_model(stored.mesh, degree, 3, kRoundTripSeed, degree % 2 == 0);
      const std::vector<Vec2> exact = model.displacement;
      document::round_displacement(model.displacement, document::EncodeOptions{}.displacement_step);
      EXPECT_NE(model.displacement, exact);
      std::ostringstream out;
      document::Writer writer(out, testing::info_of(model), {.knot_bits = kBits});
      const FrameModel written = writer.append(model);
      ASSERT_EQ(written.space, model.space);
      ASSERT_EQ(written.displacement, model.displacement);
      document::Writer finer(out, testing::info_of(model), {.knot_bits = kBits + 2});
      ASSERT_EQ(finer.append(model).space, model.space);
    }
  }
}

/// The same model over its stored space makes the same file, and is stored with that very space.
TEST(Document, StoredMeshesHaveNoGridOutOfRange) {
  const FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kRoundTripSeed), 2, 3, kRoundTripSeed);
  for (const int bits : {-1, 15, std::numeric_limits<int>::max()}) {
    EXPECT_THROW(document::stored_mesh(model.space->mesh(), bits), Error);
    EXPECT_THROW(document::stored_space(model.space, bits), Error);
  }
}

TEST(Document, AStoredSpaceHasTheFunctionsOfTheOneGiven) {
  constexpr int kBits = 5;
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      const FrameModel given = testing::random_model(c.mesh, degree, 3, kRoundTripSeed, degree % 2 == 0);
      const document::StoredSpace stored = document::stored_space(given.space, kBits);
      FrameModel model = given;
      model.space = stored.space;
      ASSERT_EQ(stored.function_of.size(), given.space->function_count());
      for (std::size_t f = 0; f < stored.function_of.size(); ++f) {
        const spline::FunctionIndex g = stored.function_of[f];
        for (std::size_t k = 0; k < 3; ++k) model.colour[3 * f + k] = given.colour[3 * g + k];
        model.displacement[stored.space->geometry_of()[f]] =
            given.displacement[given.space->geometry_of()[g]];
      }
      EXPECT_EQ(write_document({model}, {.knot_bits = kBits}), write_document({given}, {.knot_bits = kBits}));
      std::ostringstream out;
      document::Writer writer(out, testing::info_of(model), {.knot_bits = kBits});
      EXPECT_EQ(writer.append(model).space, stored.space);
    }
  }
}

TEST(Document, KeepsItsBytesWhenReadAndWrittenAgain) {
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      for (const bool rename : {false, true}) {
        document::EncodeOptions options;
        options.knot_bits = 2 * degree;
        options.rename_knots = rename;
        const auto bytes = write_document(
            {testing::random_model(c.mesh, degree, 3, kRoundTripSeed, degree % 2 == 0)}, options);
        Reader reader = Reader::open(bytes);
        ASSERT_EQ(rewritten(reader, options), bytes);
      }
    }
  }
}

TEST(Document, DoesNotDependOnTheOrderOfTheModel) {
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 2; ++degree) {
      const FrameModel model = testing::random_model(c.mesh, degree, 3, kRoundTripSeed, degree == 2);
      EXPECT_EQ(write_document({model}), write_document({testing::shuffled(model, kRoundTripSeed)}));
    }
  }
}

TEST(Document, RoundsWithinTheStatedBounds) {
  const document::EncodeOptions options;
  for (const testing::MeshCase& c : all_cases()) {
    SCOPED_TRACE(c.to_text());
    const FrameModel model = testing::random_model(c.mesh, 2, 3, kRoundTripSeed);
    Reader reader = Reader::open(write_document({model}, options));
    const FrameModel stored = reader.read(0);
    std::map<mesh::KnotId, Vec2> given;
    for (const mesh::Knot& k : model.space->mesh().knots) given[k.id] = k.position;
    double longest = 0;
    for (const mesh::FeatureSegment& s : model.space->mesh().segments) {
      longest = std::max(longest, norm(model.space->mesh().knots[s.knots.front()].position -
                                       model.space->mesh().knots[s.knots.back()].position));
    }
    for (const mesh::Knot& k : stored.space->mesh().knots) {
      const Vec2 d = k.position - given.at(k.id);
      // docs/format.md, "Bounds": a whole step per axis; on segments half a parameter step more.
      const double slack = k.kind == mesh::KnotKind::kSegment ? longest / 65536 : 0;
      EXPECT_LE(std::max(std::abs(d.x), std::abs(d.y)), 1.0 / 64 + slack);
    }
    // Control points correspond by the sum over all, since the order may differ.
    double sum = 0;
    for (std::size_t i = 0; i < model.colour.size(); ++i) sum += model.colour[i] - stored.colour[i];
    EXPECT_LE(std::abs(sum), reader.colour_tolerance() * static_cast<double>(model.colour.size()));
  }
}

TEST(Document, RefusesModelsThatDoNotFit) {
  const FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kRoundTripSeed), 2, 3, kRoundTripSeed);
  const auto refuses = [&](auto change) {
    std::ostringstream out;
    document::Writer writer(out, testing::info_of(model));
    FrameModel bad = model;
    change(bad);
    try {
      writer.append(bad);
      return false;
    } catch (const Error& e) {
      return e.kind() == ErrorKind::kInvalidArgument;
    }
  };
  EXPECT_FALSE(refuses([](FrameModel&) {}));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.colour.pop_back(); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.displacement.push_back({}); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.channels = 1; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.space = nullptr; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.colour[3] = std::nan(""); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.displacement[0].x = 1e12; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.edge_softness = 0.26; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.edge_softness = -0.01; }));
  EXPECT_FALSE(refuses([](FrameModel& m) { m.pts = -kMaxTicks; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.pts = kMaxTicks + 1; }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.pts = std::numeric_limits<std::int64_t>::min(); }));
  EXPECT_TRUE(refuses([](FrameModel& m) { m.edge_softness = std::nan(""); }));
}

TEST(Document, TakesAFinerGridWhereFacesWouldFlip) {
  testing::MeshBuilder builder(64, 48);
  builder.free(20.001, 20);
  builder.free(20.002, 20.0005);
  builder.free(40, 30);
  const FrameModel model = testing::random_model(builder.triangulated(), 2, 3, kRoundTripSeed);
  Reader reader = Reader::open(write_document({model}));
  EXPECT_EQ(reader.read(0).space->mesh().knots.size(), 7u);
  EXPECT_EQ(rewritten(reader, {}), write_document({model}));
}

}  // namespace
}  // namespace knotreel
