// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/param/parametrization.h"
#include "param/laws.h"
#include "support/chains.h"

namespace knotreel::param {
namespace {

using features::FeatureChains;
using knotreel::testing::arc;
using knotreel::testing::ChainBuilder;
using knotreel::testing::random_chains;
using testing::run_sound;

Parametrization run(const FeatureChains& chains, const ParametrizeOptions& options = {},
                    ParametrizeReport* report = nullptr) {
  return parametrize(chains, features::make_image_mesh(chains), options, report);
}

double largest_displacement(const Parametrization& p, const std::vector<Vec2>& layout) {
  double most = 0;
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const Vec2 centre{static_cast<double>(i % static_cast<std::size_t>(p.width)) + 0.5,
                      static_cast<double>(i / static_cast<std::size_t>(p.width)) + 0.5};
    most = std::max(most, norm(layout[i] - centre));
  }
  return most;
}

double largest_difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

bool same_bits(const Parametrization& a, const Parametrization& b) {
  return a.position == b.position && a.parameter == b.parameter && a.vertices.size() == b.vertices.size() &&
         std::equal(a.curve_samples.begin(), a.curve_samples.end(), b.curve_samples.begin(),
                    b.curve_samples.end(), [](const CurveSample& s, const CurveSample& t) {
                      return s.t == t.t && s.position == t.position;
                    });
}

TEST(Parametrize, WithoutChainsIsTheIdentity) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 7}, {7, 1}, {2, 2}, {3, 3}, {40, 30}}) {
    FeatureChains none;
    none.width = w;
    none.height = h;
    const Parametrization p = run_sound(none);
    EXPECT_EQ(largest_displacement(p, p.position), 0);
    EXPECT_EQ(largest_displacement(p, p.parameter), 0);
  }
}

TEST(Parametrize, TinyPicturesWithChainsWork) {
  for (int w = 1; w <= 4; ++w) {
    for (int h = 1; h <= 4; ++h) {
      if (w * h < 2) continue;
      ChainBuilder b(w, h);
      b.add({{0.5, 0.5}, {w - 0.5, h - 0.5}});
      run_sound(b.chains);
    }
  }
}

TEST(Parametrize, StraightChainsAreNearlyTheIdentity) {
  ChainBuilder b(80, 60);
  ASSERT_TRUE(b.add({{10.5, 10.5}, {60.5, 10.5}}));
  ASSERT_TRUE(b.add({{20.5, 20.5}, {50.5, 50.5}}));
  ASSERT_TRUE(b.add({{70.5, 0.5}, {70.5, 59.5}}));
  const Parametrization p = run_sound(b.chains);
  EXPECT_EQ(p.vertices.size(), 6U);
  // Fairing pulls the last points before an end inwards, nothing else.
  EXPECT_LT(largest_displacement(p, p.parameter), 0.5);
}

TEST(Parametrize, ACircleBecomesAPolygonAndItsDisplacementDiesOff) {
  ChainBuilder b(300, 300);
  ASSERT_TRUE(b.add(arc({150, 150}, 40), true));
  const Parametrization p = run_sound(b.chains);
  ASSERT_EQ(p.polylines.size(), 1U);
  EXPECT_LE(p.polylines[0].vertices.size(), 12U);
  EXPECT_GE(p.polylines[0].vertices.size(), 6U);
  EXPECT_GT(largest_displacement(p, p.parameter), 1);
  EXPECT_LT(largest_displacement(p, p.parameter), 4);
  EXPECT_GT(testing::smallest_area(features::make_image_mesh(b.chains), p, p.parameter), 0.1);
  int moved = 0;
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      const Vec2 centre{x + 0.5, y + 0.5};
      if (norm(centre - Vec2{150, 150}) < 135) continue;
      moved += p.parameter[static_cast<std::size_t>(y * 300 + x)] == centre ? 0 : 1;
    }
  }
  EXPECT_EQ(moved, 0);
}

TEST(Parametrize, CornersAreVerticesAndCurvesGoBeyondTheirPixels) {
  ChainBuilder b(120, 120);
  ASSERT_TRUE(b.add(arc({60.3, 58.9}, 33), true));
  for (const std::size_t corners : {1U, 2U, 5U}) {
    SCOPED_TRACE(corners);
    FeatureChains chains = b.chains;
    auto& points = chains.chains[0].points;
    for (std::size_t k = 0; k < corners; ++k) {
      points[17 * k + 5].corner = true;
      points[17 * k + 5].beyond = {1.5, -0.75};
    }
    const Parametrization p = run_sound(chains);
    ASSERT_EQ(p.curve_samples.size(), points.size());
    EXPECT_GE(p.vertices.size(), 3U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const CurveSample& s = p.curve_samples[i];
      EXPECT_EQ(s.position, points[i].on_curve());
      if (points[i].corner) {
        EXPECT_EQ(s.t, 0) << "a vertex";
      }
    }
  }
}

TEST(Parametrize, EndsOfCurvesGoBeyondTheirPixelsToo) {
  ChainBuilder b(80, 60);
  ASSERT_TRUE(b.add({{10.5, 10.5}, {40.5, 30.5}}));
  ASSERT_TRUE(b.add({{70.5, 20.5}, {60.5, 45.5}}));
  FeatureChains chains = b.chains;
  for (features::Chain& chain : chains.chains) {
    chain.points.front().beyond = {0.5, 1.25};
    chain.points.back().beyond = {-0.75, 1};
  }
  const Parametrization p = run_sound(chains);
  ASSERT_EQ(p.curve_samples.size(), chains.chains[0].points.size() + chains.chains[1].points.size());
  std::size_t i = 0;
  for (const features::Chain& chain : chains.chains) {
    for (const features::ChainPoint& point : chain.points)
      EXPECT_EQ(p.curve_samples[i++].position, point.on_curve());
  }
}

TEST(Parametrize, ItDoesNotMatterWhereAClosedChainStarts) {
  ChainBuilder b(120, 120);
  ASSERT_TRUE(b.add(arc({60.3, 58.9}, 33), true));
  const auto sorted_vertices = [](const FeatureChains& chains) {
    std::vector<std::pair<double, double>> sorted;
    for (const PolylineVertex& v : run_sound(chains).vertices)
      sorted.emplace_back(v.position.x, v.position.y);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  const auto expected = sorted_vertices(b.chains);
  for (int turn = 0; turn < 5; ++turn) {
    auto& points = b.chains.chains[0].points;
    std::rotate(points.begin(), points.begin() + 31, points.end());
    EXPECT_EQ(sorted_vertices(b.chains), expected);
  }
}

TEST(Parametrize, RandomChainsObeyAllLaws) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const int width = 40 + static_cast<int>(seed * 37 % 160);
    const int height = 40 + static_cast<int>(seed * 53 % 120);
    run_sound(random_chains(width, height, 3 + width * height / 900, seed));
  }
}

TEST(Parametrize, FirstPolylinesAreThoseOfTheResultUnlessItFolded) {
  int unfolded = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const FeatureChains chains = random_chains(160, 120, 3 + static_cast<int>(seed) / 2, seed);
    const Parametrization first = first_polylines(chains);
    ParametrizeReport report;
    const Parametrization whole = run(chains, {}, &report);
    EXPECT_EQ(first.width, whole.width);
    EXPECT_EQ(first.height, whole.height);
    EXPECT_TRUE(first.position.empty());
    EXPECT_LE(first.vertices.size(), whole.vertices.size());
    if (report.rounds > 1) continue;
    ++unfolded;
    EXPECT_TRUE(std::equal(first.vertices.begin(), first.vertices.end(), whole.vertices.begin(),
                           whole.vertices.end(), [](const PolylineVertex& a, const PolylineVertex& b) {
                             return a.position == b.position && a.place == b.place;
                           }));
    EXPECT_TRUE(std::equal(first.polylines.begin(), first.polylines.end(), whole.polylines.begin(),
                           whole.polylines.end(), [](const Polyline& a, const Polyline& b) {
                             return a.chain == b.chain && a.vertices == b.vertices && a.closed == b.closed;
                           }));
  }
  EXPECT_GT(unfolded, 5);
}

TEST(Parametrize, ClosePolylinesKeepTheirSides) {
  // An arc over a chain that lies between the arc and its chord.
  ChainBuilder b(120, 60);
  ASSERT_TRUE(b.add(arc({60, 140.5}, 110, -1.79, -1.35)));
  ASSERT_TRUE(b.add({{57.5, 32.5}, {62.5, 32.5}}));
  ParametrizeReport report;
  run_sound(b.chains, &report);
  EXPECT_EQ(report.folds_found, 0);  // so it is the polylines that are right, not their repair
}

TEST(Parametrize, ProjectionsAdvanceWhereAChainTurnsBack) {
  // Right, back left, and right again, all of it within three pixels of a straight line.
  FeatureChains chains;
  chains.width = 50;
  chains.height = 20;
  chains.node_count = 2;
  features::Chain chain;
  chain.last_node = 1;
  const auto push = [&](int x, int y) { chain.points.push_back({x, y, {x + 0.5, y + 0.5}}); };
  for (int x = 5; x <= 22; ++x) push(x, 12);
  push(23, 11);
  for (int x = 22; x >= 18; --x) push(x, 10);
  push(17, 9);
  for (int x = 18; x <= 40; ++x) push(x, 8);
  chains.chains.push_back(chain);
  ParametrizeReport report;
  run_sound(chains, &report);
  EXPECT_EQ(report.folds_found, 0);
}

TEST(Parametrize, ChordsBetweenTheSameNodesDoNotCoincide) {
  // Two nearly straight chains from node 0 to node 1.
  FeatureChains chains;
  chains.width = 60;
  chains.height = 30;
  chains.node_count = 2;
  for (const int bow : {-2, 2}) {
    features::Chain chain;
    chain.last_node = 1;
    for (int x = 10; x <= 40; ++x) {
      const int lift = std::min({x - 10, 40 - x, 2});
      const int y = 15 + bow * lift / 2;
      chain.points.push_back({x, y, {x + 0.5, y + 0.5}});
    }
    chains.chains.push_back(chain);
  }
  ParametrizeReport report;
  const Parametrization p = run_sound(chains, &report);
  EXPECT_GE(p.vertices.size(), 3U);
  EXPECT_EQ(report.folds_found, 0);
}

double least_distance(const Parametrization& p) {
  double least = 1e9;
  const auto each = [&](auto&& visit) {
    for (const Polyline& line : p.polylines) {
      for (std::size_t i = 0; i + 1 < line.vertices.size(); ++i)
        visit(line.vertices[i], line.vertices[i + 1]);
    }
  };
  each([&](std::uint32_t a, std::uint32_t b) {
    each([&](std::uint32_t c, std::uint32_t d) {
      if (c != a && c != b)
        least = std::min(least, distance_to_segment(p.vertices[c].position, p.vertices[a].position,
                                                    p.vertices[b].position));
      if (d != a && d != b)
        least = std::min(least, distance_to_segment(p.vertices[d].position, p.vertices[a].position,
                                                    p.vertices[b].position));
    });
  });
  return least;
}

/// One curve that ends on another but for an ulp, where both have a common node: the face in between could
/// not be stored.
TEST(Parametrize, NoPolylineEndsOnAnotherButForRounding) {
  for (const double off : {0.0, 6e-15, 1e-9, 1e-4}) {
    SCOPED_TRACE(off);
    ChainBuilder b(80, 60);
    ASSERT_TRUE(b.add_star({40.5, 30.5}, {{{40.5, 30.5}, {20.5, 30.5}}, {{40.5, 30.5}, {40.5, 33.5}}}));
    ASSERT_EQ(b.chains.chains.size(), 2U);
    features::Chain& down = b.chains.chains[1];
    for (features::ChainPoint& p : b.chains.chains[0].points) p.position.y = 31.5;  // as far as it may
    down.points[1].position = {39.9, 31.5 + off};
    down.points[1].corner = true;
    for (features::ChainPoint& p : down.points) p.position.x = p.y == 30 ? p.position.x : 39.9;
    EXPECT_GT(least_distance(first_polylines(b.chains, {})), 2e-4);
  }
}

TEST(Parametrize, FairedPositionsThatCrossFallBackToThePixels) {
  FeatureChains chains;
  chains.width = 40;
  chains.height = 20;
  chains.node_count = 4;
  for (const int row : {8, 10}) {
    features::Chain chain;
    chain.first_node = row == 8 ? 0 : 2;
    chain.last_node = chain.first_node + 1;
    for (int x = 8; x <= 30; ++x) {
      // Both curves are moved by most of a pixel towards and beyond each other.
      const double y = row + 0.5 + (x < 12 || x > 26 ? 0.0 : (row == 8 ? 1.0 : -1.1));
      chain.points.push_back({x, row, {x + 0.5, y}});
    }
    chains.chains.push_back(chain);
  }
  ParametrizeReport report;
  const Parametrization p = run_sound(chains, &report);
  EXPECT_GT(report.relaxed_points, 0);
}

TEST(Parametrize, SameBitsForAnyNumberOfThreads) {
  const FeatureChains chains = random_chains(200, 150, 30, 5);
  const auto with = [&](int threads) {
    const ThreadCap cap(threads);
    return run(chains);
  };
  EXPECT_TRUE(same_bits(with(1), with(2)));
}

TEST(Parametrize, AMirroredPictureGivesTheMirroredResult) {
  const FeatureChains chains = random_chains(151, 120, 14, 11);
  const Parametrization p = run(chains);
  Parametrization q = run(knotreel::testing::mirrored(chains));
  const auto mirror_back = [&](std::vector<Vec2>& layout) {
    for (int y = 0; y < 120; ++y) {
      const auto row = layout.begin() + y * 151;
      std::reverse(row, row + 151);
    }
    for (Vec2& v : layout) v.x = 151 - v.x;
  };
  mirror_back(q.position);
  mirror_back(q.parameter);
  EXPECT_LT(largest_difference(p.position, q.position), 5e-3);
  EXPECT_LT(largest_difference(p.parameter, q.parameter), 5e-3);
}

TEST(Parametrize, HostileFairingIsSurvived) {
  // Positions anywhere within a pixel: nothing that a detector would do, but the interface allows it.
  int folds = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    FeatureChains chains = random_chains(90, 70, 8, seed);
    unsigned state = seed;
    const auto noise = [&] {
      state = state * 1664525U + 1013904223U;
      return (state >> 8) / double(1 << 24) * 1.8 - 0.9;
    };
    std::vector<Vec2> at_node(chains.node_count, Vec2{});
    for (Vec2& v : at_node) v = {noise(), noise()};
    for (features::Chain& chain : chains.chains) {
      for (std::size_t i = 0; i < chain.points.size(); ++i) {
        features::ChainPoint& c = chain.points[i];
        Vec2 shift{noise(), noise()};
        if (!chain.closed && i == 0) shift = at_node[chain.first_node];
        if (!chain.closed && i + 1 == chain.points.size()) shift = at_node[chain.last_node];
        c.position = Vec2{c.x + 0.5, c.y + 0.5} + shift;
      }
    }
    ParametrizeReport report;
    run_sound(chains, &report);
    folds += report.folds_found;
  }
  EXPECT_GT(folds, 0);  // or this test is none of the repair
}

TEST(Parametrize, MisuseIsRefused) {
  ChainBuilder b(30, 20);
  ASSERT_TRUE(b.add({{5.5, 5.5}, {20.5, 5.5}}));
  const auto mesh = features::make_image_mesh(b.chains);
  const auto refused = [&](const auto& change) {
    FeatureChains chains = b.chains;
    ParametrizeOptions options;
    change(chains, options);
    EXPECT_THROW(parametrize(chains, mesh, options), Error);
    if (chains.width == mesh.width) {
      EXPECT_THROW(first_polylines(chains, options), Error);
    }
  };
  refused([](FeatureChains& c, auto&) { c.width = 31; });
  refused([](FeatureChains& c, auto&) { c.chains[0].points[2].x = 40; });
  refused([](FeatureChains& c, auto&) { c.chains[0].points[2].position.x = std::nan(""); });
  refused([](FeatureChains& c, auto&) { c.chains[0].points.resize(1); });
  refused([](FeatureChains& c, auto&) { c.chains[0].last_node = 9; });
  refused([](FeatureChains& c, auto&) { c.chains.push_back(c.chains[0]); });
  refused([](auto&, ParametrizeOptions& o) { o.polyline_distance = 0; });
  refused([](auto&, ParametrizeOptions& o) { o.stepped_distance = -1; });
  refused([](auto&, ParametrizeOptions& o) { o.decay = -1; });
}

/// The vertices of polylines, as places in the picture.
std::vector<Vec2> vertex_places(const Parametrization& p) {
  std::vector<Vec2> places;
  for (const CurveSample& s : p.curve_samples)
    if (s.t == 0 || s.t == 1) places.push_back(s.position);
  return places;
}

void prefer(FeatureChains& chains, const std::vector<Vec2>& places) {
  for (features::Chain& chain : chains.chains) {
    for (features::ChainPoint& p : chain.points) {
      p.preferred =
          std::any_of(places.begin(), places.end(), [&](Vec2 v) { return norm(p.position - v) < 1e-9; });
    }
  }
}

TEST(Parametrize, PreferredPointsAreVerticesInPlaceOfOthers) {
  FeatureChains chains = [] {
    ChainBuilder b(80, 80);
    b.add(arc({40, 40}, 25), true);
    return std::move(b.chains);
  }();
  ParametrizeOptions options;
  options.polyline_distance = 1;
  const std::vector<Vec2> by_itself = vertex_places(first_polylines(chains, options));
  // Half way between those that it would have.
  std::vector<Vec2> wanted;
  const std::vector<features::ChainPoint>& points = chains.chains[0].points;
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::any_of(by_itself.begin(), by_itself.end(),
                    [&](Vec2 v) { return norm(points[i].position - v) < 1e-9; }))
      at.push_back(i);
  ASSERT_EQ(at.size(), by_itself.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::size_t next = i + 1 < at.size() ? at[i + 1] : at[0] + points.size();
    wanted.push_back(points[(at[i] + next) / 2 % points.size()].position);
  }
  prefer(chains, wanted);
  const std::vector<Vec2> led = vertex_places(first_polylines(chains, options));
  for (const Vec2 v : wanted)
    EXPECT_TRUE(std::any_of(led.begin(), led.end(), [&](Vec2 w) { return norm(v - w) < 1e-9; }))
        << v.x << ' ' << v.y;
  EXPECT_LE(led.size(), by_itself.size() + 2);
  run_sound(chains);
}

TEST(Parametrize, PreferredPointsThatNobodyNeedsAreNoVertices) {
  FeatureChains chains = [] {
    ChainBuilder b(80, 40);
    b.add({{10, 10}, {70, 30}});
    return std::move(b.chains);
  }();
  const std::size_t count = first_polylines(chains).vertices.size();
  for (features::ChainPoint& p : chains.chains[0].points) p.preferred = true;
  EXPECT_EQ(first_polylines(chains).vertices.size(), count);
}

TEST(Parametrize, PreferredPointsNextToOthersAreNoVertices) {
  FeatureChains chains = [] {
    ChainBuilder b(80, 80);
    b.add(arc({40, 40}, 25), true);
    return std::move(b.chains);
  }();
  std::vector<features::ChainPoint>& points = chains.chains[0].points;
  ParametrizeOptions options;
  options.polyline_distance = 1;
  for (const std::size_t first : {std::size_t{0}, std::size_t{7}, points.size() - 1}) {
    for (features::ChainPoint& p : points) p.preferred = false;
    // So far apart that none may go for being straight.
    for (std::size_t i = 0; i + 15 < points.size(); ++i)
      points[(first + 1 + i) % points.size()].preferred = i % 20 == 0;
    points[first].preferred = true;
    const Parametrization p = first_polylines(chains, options);
    std::vector<std::size_t> vertices;
    for (std::size_t i = 0; i < p.curve_samples.size(); ++i)
      if (p.curve_samples[i].t == 0) vertices.push_back(i);
    vertices.push_back(vertices.front() + points.size());
    for (std::size_t i = 1; i < vertices.size(); ++i)
      EXPECT_GT(vertices[i] - vertices[i - 1], 2U) << first << ": " << vertices[i];
  }
}

TEST(Parametrize, AnyPreferencesGiveSoundPolylines) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    FeatureChains chains = random_chains(96, 80, 14, seed);
    unsigned state = seed;
    for (features::Chain& chain : chains.chains) {
      for (features::ChainPoint& p : chain.points) {
        state = state * 1664525U + 1013904223U;
        p.preferred = state >> 29 == 0;
      }
    }
    SCOPED_TRACE(seed);
    const Parametrization p = run_sound(chains);
    for (const Polyline& line : p.polylines) EXPECT_GE(line.vertices.size(), line.closed ? 3U : 2U);
  }
}

}  // namespace
}  // namespace knotreel::param
