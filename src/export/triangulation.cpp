// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/triangulation.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <unordered_map>

#include "export/patch_stream.h"
#include "export/sheets.h"

namespace knotreel::exporting {

namespace {

struct ByParameter {
  std::size_t operator()(const Vec2& u) const {
    const auto mixed = [](std::uint64_t v) {
      v *= 0x9e3779b97f4a7c15U;
      return v ^ (v >> 29);
    };
    return mixed(std::bit_cast<std::uint64_t>(u.x) + mixed(std::bit_cast<std::uint64_t>(u.y)));
  }
};

class Builder {
 public:
  explicit Builder(const Tessellator& tessellator) : sheets_(tessellator.sheets()) {}

  void add(std::uint32_t face, const Patch& patch) {
    std::vector<std::uint32_t> vertex(patch.vertices.size());
    for (std::size_t i = 0; i < vertex.size(); ++i) vertex[i] = vertex_at(patch.vertices[i]);
    for (const auto& corners : patch.triangles) {
      // What tests of equality have found to be one point has no area, and would be its own neighbour.
      const std::array<std::uint32_t, 3> t{vertex[corners[0]], vertex[corners[1]], vertex[corners[2]]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      result_.triangles.push_back(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& colour = patch.vertices[corners[i]].colour;
        result_.colour.push_back({static_cast<float>(colour[0]), static_cast<float>(colour[1]),
                                  static_cast<float>(colour[2]), static_cast<float>(colour[3])});
        result_.piece.push_back(piece(face, patch.weights[corners[i]], patch.weights[corners[(i + 1) % 3]]));
      }
    }
  }

  Triangulation finish() {
    connect();
    return std::move(result_);
  }

 private:
  /// Both sides of a feature have the same parameters there, bit for bit, and one curve in the image.
  std::uint32_t vertex_at(const SurfacePoint& point) {
    const Vec2 u{point.u.x + 0.0, point.u.y + 0.0};  // -0 is 0
    const auto [entry, is_new] = vertices_.try_emplace(u, static_cast<std::uint32_t>(result_.x.size()));
    if (is_new) result_.x.push_back(point.x);
    return entry->second;
  }

  std::uint32_t piece(std::uint32_t face, const std::array<double, 3>& from,
                      const std::array<double, 3>& to) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t h = 3 * face + i;
      if (from[(i + 2) % 3] != 0 || to[(i + 2) % 3] != 0 || !sheets_.is_feature(h)) continue;
      result_.pieces.push_back({h, from[(i + 1) % 3], to[(i + 1) % 3]});
      return static_cast<std::uint32_t>(result_.pieces.size() - 1);
    }
    return kNoIndex;
  }

  void connect() {
    struct Edge {
      std::uint32_t low, high, half_edge;
    };
    std::vector<Edge> edges(3 * result_.triangles.size());
    for (std::uint32_t h = 0; h < edges.size(); ++h) {
      const std::uint32_t a = result_.vertex(h);
      const std::uint32_t b = result_.target(h);
      edges[h] = {std::min(a, b), std::max(a, b), h};
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
    });
    result_.opposite.assign(edges.size(), kNoIndex);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const Edge& a = edges[i];
      const Edge& b = edges[i + 1];
      if (a.low != b.low || a.high != b.high) continue;
      result_.opposite[a.half_edge] = b.half_edge;
      result_.opposite[b.half_edge] = a.half_edge;
      ++i;
    }
  }

  const Sheets& sheets_;
  Triangulation result_;
  std::unordered_map<Vec2, std::uint32_t, ByParameter> vertices_;
};

}  // namespace

Corners corners_of(const Triangulation& triangles, std::uint32_t triangle, std::size_t first,
                   std::size_t count) {
  Corners corners;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t h = 3 * triangle + k;
    corners.x[k] = triangles.origin(h);
    for (std::size_t c = 0; c < count; ++c) corners.colour[k][c] = double{triangles.colour[h][first + c]};
  }
  return corners;
}

Triangulation triangulate(const Tessellator& tessellator, std::uint64_t max_triangles,
                          const std::function<void()>& checkpoint) {
  TriangleBudget budget(max_triangles);
  Builder builder(tessellator);
  std::uint32_t face = 0;
  for_each_face(tessellator, checkpoint, budget, [&](const Patch& patch) { builder.add(face++, patch); });
  return builder.finish();
}

}  // namespace knotreel::exporting
