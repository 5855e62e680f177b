// SPDX-License-Identifier: GPL-3.0-or-later
// docs/format.md against the library: a reader written from the page must find the same model.

#include <gtest/gtest.h>

#include <random>

#include "document/independent_reader.h"
#include "document/sample_models.h"
#include "knotreel/document/reader.h"
#include "knotreel/spline/basis.h"
#include "support/mesh_cases.h"

namespace knotreel {
namespace {

using document::FrameModel;
using testing::IndependentModel;
using testing::Point;

constexpr std::uint64_t kFormatSeed = 12;

void expect_same_model(const IndependentModel& independent, const FrameModel& model) {
  const spline::SplineSpace& space = *model.space;
  const mesh::KnotMesh& mesh = space.mesh();
  ASSERT_EQ(independent.degree, space.degree());
  ASSERT_EQ(independent.channels, model.channels);
  ASSERT_EQ(independent.edge_softness, model.edge_softness);
  ASSERT_EQ(independent.knots.size(), mesh.knots.size());
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
    ASSERT_EQ(independent.knots[k][0], mesh.knots[k].position.x) << k;
    ASSERT_EQ(independent.knots[k][1], mesh.knots[k].position.y) << k;
    ASSERT_EQ(independent.ids[k], static_cast<std::uint32_t>(mesh.knots[k].id)) << k;
  }
  ASSERT_EQ(independent.faces.size(), mesh.faces.size());
  ASSERT_EQ(independent.segments.size(), mesh.segments.size());
  ASSERT_EQ(independent.functions.size(), space.function_count());
  const auto channels = static_cast<std::size_t>(model.channels);
  for (std::uint32_t f = 0; f < space.function_count(); ++f) {
    for (std::size_t i = 0; i < independent.functions[f].size(); ++i) {
      ASSERT_EQ(static_cast<std::uint32_t>(independent.functions[f][i]), space.functions()[f].knots[i]) << f;
    }
    const Vec2 g = space.greville(f) + model.displacement[space.geometry_of()[f]];
    ASSERT_NEAR(independent.control[f][0], g.x, 1e-12);
    ASSERT_NEAR(independent.control[f][1], g.y, 1e-12);
    for (std::size_t c = 0; c < channels; ++c) {
      ASSERT_EQ(independent.control[f][2 + c], model.colour[channels * f + c]) << f;
    }
  }
}

void expect_same_surface(const IndependentModel& independent, const FrameModel& model, Point u) {
  std::vector<spline::BasisValue> values;
  spline::Basis(model.space).evaluate({u[0], u[1]}, values);
  std::vector<double> expected(2 + static_cast<std::size_t>(model.channels), 0.0);
  for (const auto& [f, b] : values) {
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += b * independent.control[f][i];
  }
  const std::vector<double> actual = independent.surface(u);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-7);
}

void expect_format_holds(const FrameModel& given, std::mt19937_64& random) {
  document::EncodeOptions options;
  options.rename_knots = random() % 2 == 0;
  const auto bytes = testing::write_document({given}, options);
  const FrameModel model = document::Reader::open(bytes).read(0);
  const IndependentModel independent = testing::read_independently(bytes);
  expect_same_model(independent, model);
  if (::testing::Test::HasFatalFailure()) return;
  for (int i = 0; i < 2; ++i) {
    expect_same_surface(independent, model,
                        {independent.width * (static_cast<double>(random() % 99991) + 0.5) / 99991,
                         independent.height * (static_cast<double>(random() % 99989) + 0.5) / 99989});
  }
}

TEST(Format, AReaderWrittenFromThePageFindsTheSameModel) {
  auto cases = testing::corpus_cases();
  for (auto& c : testing::random_cases(kFormatSeed, 40)) cases.push_back(std::move(c));
  std::mt19937_64 random(kFormatSeed);
  for (const testing::MeshCase& c : cases) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      const int channels = 1 + static_cast<int>(random() % 4);
      expect_format_holds(testing::random_model(c.mesh, degree, channels, kFormatSeed, true), random);
      ASSERT_FALSE(HasFatalFailure());
    }
  }
}

TEST(Format, TheSameForALargeFrame) {
  std::mt19937_64 random(kFormatSeed);
  expect_format_holds(testing::picture_model(320, 240, 800, kFormatSeed), random);
}

}  // namespace
}  // namespace knotreel
