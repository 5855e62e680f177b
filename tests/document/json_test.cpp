// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "document/plain_recurrence.h"
#include "document/sample_models.h"
#include "knotreel/document/reader.h"
#include "knotreel/spline/basis.h"
#include "support/mesh_cases.h"

namespace knotreel {
namespace {

using document::FrameModel;
using nlohmann::json;
using testing::Point;

constexpr std::uint64_t kJsonSeed = 5;

/// sum over I of B_I(u) c_I, from the JSON alone.
std::vector<double> surface(const json& frame, Point u) {
  const std::vector<Point> knots = frame["knots"].get<std::vector<Point>>();
  std::vector<double> sum(frame["basis"][0]["c"].size(), 0.0);
  for (const json& f : frame["basis"]) {
    double b = 0;
    for (const json& t : f["T"]) {
      std::vector<Point> v;
      for (const std::size_t k : t) v.push_back(knots[k]);
      const double area = testing::plain_area(v[0], v[1], v[2]);
      for (const std::size_t k : f["I"]) v.push_back(knots[k]);
      b += area * testing::plain_simplex_spline(u, v);
    }
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += b * f["c"][i].get<double>();
  }
  return sum;
}

std::vector<double> surface(const FrameModel& model, const spline::Basis& basis, Point u) {
  const auto channels = static_cast<std::size_t>(model.channels);
  std::vector<double> sum(2 + channels, 0.0);
  std::vector<spline::BasisValue> values;
  basis.evaluate({u[0], u[1]}, values);
  for (const auto& [f, b] : values) {
    const Vec2 g = model.space->greville(f) + model.displacement[model.space->geometry_of()[f]];
    sum[0] += b * g.x;
    sum[1] += b * g.y;
    for (std::size_t c = 0; c < channels; ++c) sum[2 + c] += b * model.colour[channels * f + c];
  }
  return sum;
}

std::vector<testing::MeshCase> cases() {
  std::vector<testing::MeshCase> result = testing::corpus_cases();
  for (auto& c : testing::random_cases(kJsonSeed, 10)) result.push_back(std::move(c));
  return result;
}

TEST(Json, HoldsTheWholeSurface) {
  std::mt19937_64 random(kJsonSeed);
  for (const testing::MeshCase& c : cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      const FrameModel model = testing::random_model(c.mesh, degree, 3, kJsonSeed, true);
      const json frame = json::parse(document::frame_to_json(model, testing::info_of(model)));
      const spline::Basis basis(model.space);
      for (int i = 0; i < 3; ++i) {
        const Point u{c.mesh.width * (static_cast<double>(random() % 99991) + 0.5) / 99991,
                      c.mesh.height * (static_cast<double>(random() % 99989) + 0.5) / 99989};
        const std::vector<double> expected = surface(model, basis, u);
        const std::vector<double> actual = surface(frame, u);
        ASSERT_EQ(actual.size(), expected.size());
        for (std::size_t k = 0; k < actual.size(); ++k) EXPECT_NEAR(actual[k], expected[k], 1e-7);
      }
    }
  }
}

TEST(Json, UsesEveryCopyOfAKnotOncePerConfig) {
  for (const testing::MeshCase& c : cases()) {
    SCOPED_TRACE(c.to_text());
    for (int degree = 1; degree <= 3; ++degree) {
      const FrameModel model = testing::random_model(c.mesh, degree, 1, kJsonSeed);
      const json frame = json::parse(document::frame_to_json(model, testing::info_of(model)));
      for (const json& f : frame["basis"]) {
        EXPECT_EQ(f["I"].size(), static_cast<std::size_t>(degree));
        EXPECT_EQ(f["c"].size(), 3u);
        for (const json& t : f["T"]) {
          std::set<std::size_t> used;
          for (const std::size_t k : f["I"]) EXPECT_TRUE(used.insert(k).second);
          for (const std::size_t k : t) EXPECT_TRUE(used.insert(k).second);
          EXPECT_LT(*used.rbegin(), frame["knots"].size());
        }
      }
    }
  }
}

TEST(Json, SaysWhatTheFrameIs) {
  FrameModel model = testing::random_model(testing::random_mesh(64, 48, 12, 1, kJsonSeed), 2, 4, kJsonSeed);
  model.frame = 7;
  model.pts = -3;
  document::Reader reader = document::Reader::open(testing::write_document({model}));
  const json frame = json::parse(document::frame_to_json(reader.read(0), reader.info()));
  EXPECT_EQ(frame["degree"], 2);
  EXPECT_EQ(frame["width"], 64);
  EXPECT_EQ(frame["height"], 48);
  EXPECT_EQ(frame["channels"], 4);
  EXPECT_EQ(frame["frame"], 7);
  EXPECT_EQ(frame["pts"], -3);
  EXPECT_EQ(frame["time_base"], json::parse("[1,25]"));
  EXPECT_EQ(frame["domain"], json::parse("[64.0,48.0]"));
  EXPECT_EQ(frame["features"].size(), 2u);
  EXPECT_EQ(frame["basis"][1]["id"], 1);
}

}  // namespace
}  // namespace knotreel
