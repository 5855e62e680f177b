// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace knotreel::param::testing {
namespace {

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quadruple;
#else
using Quadruple = long double;  // of 113 bits on Arm
#endif

int side(Vec2 a, Vec2 b, Vec2 c) {
  const auto q = [](double v) { return static_cast<Quadruple>(v); };
  const Quadruple det = (q(b.x) - q(a.x)) * (q(c.y) - q(a.y)) - (q(b.y) - q(a.y)) * (q(c.x) - q(a.x));
  return det > 0 ? 1 : (det < 0 ? -1 : 0);
}

struct Segment {
  std::uint32_t from, to;
  Vec2 a, b;
};

bool meet(const Segment& s, const Segment& t) {
  if (std::max(s.a.x, s.b.x) < std::min(t.a.x, t.b.x) || std::max(t.a.x, t.b.x) < std::min(s.a.x, s.b.x) ||
      std::max(s.a.y, s.b.y) < std::min(t.a.y, t.b.y) || std::max(t.a.y, t.b.y) < std::min(s.a.y, s.b.y)) {
    return false;
  }
  return side(s.a, s.b, t.a) * side(s.a, s.b, t.b) <= 0 && side(t.a, t.b, s.a) * side(t.a, t.b, s.b) <= 0;
}

bool overlap_from(Vec2 common, Vec2 b, Vec2 c) {
  return side(common, b, c) == 0 && dot(b - common, c - common) > 0;
}

bool in_conflict(const Segment& s, const Segment& t) {
  if ((s.from == t.from && s.to == t.to) || (s.from == t.to && s.to == t.from)) return true;
  if (s.from == t.from) return overlap_from(s.a, s.b, t.b);
  if (s.from == t.to) return overlap_from(s.a, s.b, t.a);
  if (s.to == t.from) return overlap_from(s.b, s.a, t.b);
  if (s.to == t.to) return overlap_from(s.b, s.a, t.a);
  return meet(s, t);
}

void expect_planar(const Parametrization& p) {
  std::vector<Segment> segments;
  for (const Polyline& line : p.polylines) {
    const std::size_t n = line.vertices.size();
    ASSERT_GE(n, line.closed ? 3U : 2U);
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
      const std::uint32_t a = line.vertices[i];
      const std::uint32_t b = line.vertices[(i + 1) % n];
      segments.push_back({a, b, p.vertices[a].position, p.vertices[b].position});
    }
  }
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t k = i + 1; k < segments.size(); ++k) {
      ASSERT_FALSE(in_conflict(segments[i], segments[k]))
          << "(" << segments[i].a.x << "," << segments[i].a.y << ")-(" << segments[i].b.x << ","
          << segments[i].b.y << ") and (" << segments[k].a.x << "," << segments[k].a.y << ")-("
          << segments[k].b.x << "," << segments[k].b.y << ")";
    }
  }
}

void expect_vertices_in_place(const Parametrization& p) {
  for (const PolylineVertex& v : p.vertices) {
    const double w = p.width;
    const double h = p.height;
    const bool inside = v.position.x > 0 && v.position.y > 0 && v.position.x < w && v.position.y < h;
    EXPECT_EQ(inside, v.place == VertexPlace::kInside);
    const bool in_place = inside || (v.place == VertexPlace::kLeft && v.position.x == 0) ||
                          (v.place == VertexPlace::kRight && v.position.x == w) ||
                          (v.place == VertexPlace::kTop && v.position.y == 0) ||
                          (v.place == VertexPlace::kBottom && v.position.y == h);
    EXPECT_TRUE(in_place) << v.position.x << " " << v.position.y;
    if (inside) continue;
    for (const Vec2 corner : {Vec2{0, 0}, Vec2{w, 0}, Vec2{0, h}, Vec2{w, h}}) {
      EXPECT_GE(norm(v.position - corner), 2);
    }
  }
}

/// Samples advance along their polylines, and their pixels are where they say.
void expect_samples(const features::FeatureChains& chains, const Parametrization& p) {
  std::size_t pixels = 0;
  std::vector<Vec2> beyond(p.position.size());
  for (const features::Chain& c : chains.chains) {
    pixels += c.points.size();
    for (const features::ChainPoint& q : c.points)
      beyond[static_cast<std::size_t>(q.y * chains.width + q.x)] = q.beyond;
  }
  std::size_t seen = 0;
  for (std::size_t i = 0; i < p.curve_samples.size(); ++i) {
    const CurveSample& s = p.curve_samples[i];
    const Polyline& line = p.polylines[s.polyline];
    const std::size_t n = line.vertices.size();
    const std::size_t segments = line.closed ? n : n - 1;
    ASSERT_LT(s.segment, segments);
    ASSERT_GE(s.t, 0);
    ASSERT_LE(s.t, 1);
    const Vec2 a = p.vertices[line.vertices[s.segment]].position;
    const Vec2 b = p.vertices[line.vertices[(s.segment + 1) % n]].position;
    const Vec2 on_line = a + s.t * (b - a);
    EXPECT_LT(norm(on_line - s.position), 3 + 1e-9);
    if (s.pixel != kNoPixel) {
      ++seen;
      EXPECT_LT(norm(p.parameter[static_cast<std::size_t>(s.pixel)] - on_line), 1e-6);
      const auto pixel = static_cast<std::size_t>(s.pixel);
      EXPECT_EQ(p.position[pixel] + beyond[pixel], s.position);
    }
    if (i == 0 || p.curve_samples[i - 1].polyline != s.polyline) continue;
    const CurveSample& before = p.curve_samples[i - 1];
    const bool same = before.segment == s.segment && before.t < s.t;
    const bool next = s.segment == (before.segment + 1) % segments && s.t == 0;
    EXPECT_TRUE(same || next) << "sample " << i;
  }
  EXPECT_GE(seen, pixels);
}

std::vector<bool> feature_pixels(const Parametrization& p) {
  std::vector<bool> is_feature(p.position.size(), false);
  for (const CurveSample& s : p.curve_samples) {
    if (s.pixel != kNoPixel) is_feature[static_cast<std::size_t>(s.pixel)] = true;
  }
  return is_feature;
}

template <typename Body>
void for_triangles(const features::ImageMesh& mesh, const Body& body) {
  for (int y = 0; y + 1 < mesh.height; ++y) {
    for (int x = 0; x + 1 < mesh.width; ++x) {
      const auto a = static_cast<std::size_t>(y * mesh.width + x);
      const std::size_t b = a + 1;
      const std::size_t d = a + static_cast<std::size_t>(mesh.width);
      const std::size_t c = d + 1;
      if (mesh.diagonals[static_cast<std::size_t>(y * (mesh.width - 1) + x)] == 0) {
        body(a, b, c);
        body(a, c, d);
      } else {
        body(a, b, d);
        body(b, c, d);
      }
    }
  }
}

}  // namespace

double smallest_area(const features::ImageMesh& mesh, const Parametrization& p,
                     const std::vector<Vec2>& layout) {
  const std::vector<bool> is_feature = feature_pixels(p);
  double least = std::numeric_limits<double>::infinity();
  for_triangles(mesh, [&](std::size_t a, std::size_t b, std::size_t c) {
    const double area = signed_area(layout[a], layout[b], layout[c]);
    if (is_feature[a] && is_feature[b] && is_feature[c]) {
      EXPECT_GT(area, -1e-6);
    } else {
      least = std::min(least, area);
    }
  });
  return least;
}

void expect_sound(const features::FeatureChains& chains, const features::ImageMesh& mesh,
                  const Parametrization& p) {
  ASSERT_EQ(p.position.size(), static_cast<std::size_t>(chains.width * chains.height));
  ASSERT_EQ(p.parameter.size(), p.position.size());
  ASSERT_EQ(p.polylines.size(), chains.chains.size());
  expect_planar(p);
  expect_vertices_in_place(p);
  expect_samples(chains, p);
  EXPECT_GT(smallest_area(mesh, p, p.position), 0);
  EXPECT_GT(smallest_area(mesh, p, p.parameter), 0);
  for (const Vec2 v : p.parameter) {
    ASSERT_TRUE(v.x > 0 && v.y > 0 && v.x < p.width && v.y < p.height);
  }
}

Parametrization run_sound(const features::FeatureChains& chains, ParametrizeReport* report) {
  ParametrizeReport local;
  const auto mesh = features::make_image_mesh(chains);
  Parametrization p = parametrize(chains, mesh, {}, &local);
  EXPECT_EQ(local.dropped_chains, 0);
  EXPECT_EQ(local.folds_left, 0);
  expect_sound(chains, mesh, p);
  if (report != nullptr) *report = local;
  return p;
}

}  // namespace knotreel::param::testing
