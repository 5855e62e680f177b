// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/export/tessellate.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <set>

#include "export/layers.h"
#include "export/sheets.h"
#include "export_models.h"
#include "knotreel/base/error.h"
#include "knotreel/mesh/triangulate.h"

namespace knotreel::exporting {
namespace {

using namespace knotreel::testing;

std::vector<MeshCase> few_cases() {
  std::vector<MeshCase> cases;
  for (const char* name : {"free-knots", "two-tips", "three-fold-junction", "loop-with-tail",
                           "knots-squeezed-on-feature", "domain-corner-to-corner", "ends-on-border"}) {
    cases.push_back(corpus_case(name));
  }
  for (MeshCase& c : random_cases(5, 3)) cases.push_back(std::move(c));
  return cases;
}

double reach_of(const MeshCase& c) {
  return c.name == "knots-squeezed-on-feature" ? 0 : 1.5;
}

TEST(Tessellate, KeepsTheTolerancesBetweenItsSamples) {
  for (const MeshCase& c : few_cases()) {
    // Its colours change within hundredths of a pixel, below the shortest edge.
    if (c.name == "knots-squeezed-on-feature") continue;
    SCOPED_TRACE(c.name);
    for (const int degree : {1, 2, 3}) {
      document::FrameModel model = blank_model(c.mesh, degree, 3);
      displace_randomly(model, reach_of(c), 3);
      colour_randomly(model, 3);
      const TessellationOptions options{4, 0.1};
      const Tessellator tessellator(model, options);
      double colour = 0;
      double geometry = 0;
      for (std::size_t f = 0; f < tessellator.face_count(); f += 3) {
        const Patch patch = tessellator.face(f);
        for (const auto& t : patch.triangles) {
          const SurfacePoint* v[3] = {&patch.vertices[t[0]], &patch.vertices[t[1]], &patch.vertices[t[2]]};
          for (const std::array<double, 3> w :
               {std::array{0.6, 0.3, 0.1}, {0.2, 0.2, 0.6}, {0.3, 0.4, 0.3}}) {
            SurfacePoint linear{};
            for (std::size_t i = 0; i < 3; ++i) {
              linear.u = linear.u + w[i] * v[i]->u;
              linear.x = linear.x + w[i] * v[i]->x;
              for (std::size_t k = 0; k < 3; ++k) linear.colour[k] += w[i] * v[i]->colour[k];
            }
            const SurfacePoint exact = tessellator.sheets().at(linear.u);
            geometry = std::max(geometry, norm(exact.x - linear.x));
            for (std::size_t k = 0; k < 3; ++k) {
              colour = std::max(colour, std::abs(exact.colour[k] - linear.colour[k]));
            }
          }
        }
      }
      // Kinks between the samples may take a little more.
      EXPECT_LE(colour, 1.25 * options.colour_tolerance) << "degree " << degree;
      EXPECT_LE(geometry, 1.25 * options.geometry_tolerance) << "degree " << degree;
    }
  }
}

/// Every edge of a triangle has the same edge of another triangle on its other side, or lies on the border:
/// no gap and no T-junction, across features neither.
TEST(Tessellate, IsWatertight) {
  for (const MeshCase& c : few_cases()) {
    SCOPED_TRACE(c.name);
    document::FrameModel model = blank_model(c.mesh, 2, 3);
    displace_randomly(model, reach_of(c), 4);
    colour_randomly(model, 4);
    const Tessellator tessellator(model, {8, 0.1});
    using Point = std::pair<double, double>;
    std::map<std::pair<Point, Point>, int> edges;
    double area = 0;
    for (std::size_t f = 0; f < tessellator.face_count(); ++f) {
      const Patch patch = tessellator.face(f);
      for (const auto& t : patch.triangles) {
        const auto point = [&](std::size_t i) {
          // On a feature the two sides round differently.
          const Vec2 u = patch.vertices[t[i % 3]].u;
          return Point{std::round(u.x * 1e8), std::round(u.y * 1e8)};
        };
        for (std::size_t i = 0; i < 3; ++i) {
          ++edges[{point(i), point(i + 1)}];
          --edges[{point(i + 1), point(i)}];
        }
        area += signed_area(patch.vertices[t[0]].u, patch.vertices[t[1]].u, patch.vertices[t[2]].u);
      }
    }
    EXPECT_NEAR(area, c.mesh.width * c.mesh.height, 1e-6 * area);
    const auto on_side = [&](Point p, Point q) {
      return (p.first == q.first && (p.first == 0 || p.first == c.mesh.width * 1e8)) ||
             (p.second == q.second && (p.second == 0 || p.second == c.mesh.height * 1e8));
    };
    int open = 0;
    for (const auto& [edge, count] : edges) {
      if (count != 0 && !on_side(edge.first, edge.second)) ++open;
    }
    EXPECT_EQ(open, 0);
  }
}

TEST(Tessellate, RefusesTolerancesOutOfRange) {
  const document::FrameModel model = blank_model(corpus_case("one-free-knot").mesh, 2, 1);
  for (const TessellationOptions options :
       {TessellationOptions{0, 0.1}, {2, 0}, {256, 0.1}, {2, std::nan("")}}) {
    EXPECT_THROW(Tessellator(model, options), Error);
  }
}

TEST(Layers, DifferOnTheTwoSidesOfEveryFeature) {
  std::vector<MeshCase> cases = corpus_cases();
  for (MeshCase& c : random_cases(11, 30)) cases.push_back(std::move(c));
  for (const MeshCase& c : cases) {
    SCOPED_TRACE(c.name);
    const document::FrameModel model = blank_model(c.mesh, 2, 1);
    const Sheets sheets(model);
    const std::vector<std::uint32_t> layer = assign_layers(sheets);
    for (std::uint32_t h = 0; h < sheets.half_edge_count(); ++h) {
      if (!sheets.is_feature(h)) continue;
      const std::uint32_t o = sheets.opposite(h);
      EXPECT_NE(layer[h / 3], layer[o / 3]);
      if (sheets.origin(h) == sheets.target(o)) continue;
      for (const std::uint32_t a : sheets.around(sheets.origin(h))) {
        for (const std::uint32_t b : sheets.around(sheets.target(o))) EXPECT_NE(layer[a / 3], layer[b / 3]);
      }
    }
    EXPECT_LE(*std::max_element(layer.begin(), layer.end()), 3u);
  }
}

std::size_t peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) >> 10;
}

/// All faces meet in a corner of the picture, and a feature from there parts them.
TEST(Layers, TakeNoMemoryByPairsOfFacesOfAFan) {
  constexpr std::uint32_t kBorder = 12000;
  mesh::KnotMesh mesh = mesh::make_domain(4000, 4000);
  for (std::uint32_t i = 1; i < kBorder; ++i)
    mesh.knots.push_back({{4000, i * (4000.0 / kBorder)}, mesh::KnotKind::kBorder, mesh::KnotId{i + 3}});
  const auto at = [](std::uint32_t i) -> mesh::KnotIndex { return i == 0 ? 1 : i == kBorder ? 2 : i + 3; };
  for (std::uint32_t i = 0; i < kBorder; ++i) mesh.faces.push_back({0, at(i), at(i + 1)});
  mesh.faces.push_back({0, 2, 3});
  const mesh::KnotIndex end = at(kBorder / 3);
  mesh.knots[end].kind = mesh::KnotKind::kVertex;
  mesh.segments.push_back({{0, end}});
  const document::FrameModel model = blank_model(mesh, 1, 1);
  const Sheets sheets(model);

  const std::size_t before = peak_megabytes();
  const std::vector<Layer> layers = make_layers(sheets);
  EXPECT_LT(peak_megabytes(), before + 100);
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].faces.size(), 2 * kBorder / 3 + 1);
  EXPECT_EQ(layers[1].faces.size(), kBorder / 3);
}

TEST(Layers, CoverEveryFaceOnce) {
  const document::FrameModel model = blank_model(corpus_case("tip-inside-loop").mesh, 2, 1);
  const Sheets sheets(model);
  std::multiset<std::uint32_t> faces;
  for (const Layer& layer : make_layers(sheets)) faces.insert(layer.faces.begin(), layer.faces.end());
  ASSERT_EQ(faces.size(), sheets.faces().size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) EXPECT_EQ(faces.count(f), 1u);
}

}  // namespace
}  // namespace knotreel::exporting
