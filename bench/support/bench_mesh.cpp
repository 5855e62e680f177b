// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/bench_mesh.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/mesh/triangulate.h"

namespace knotreel::bench {

using mesh::KnotIndex;
using mesh::KnotKind;

namespace {

class PictureMesh {
 public:
  PictureMesh(double width, double height, std::uint64_t seed)
      : mesh_(mesh::make_domain(width, height)), random_(seed) {}

  /// Polylines live in cells of their own, so that they cannot cross.
  void add_features(int count) {
    const int columns = std::max(1, static_cast<int>(std::sqrt(count * mesh_.width / mesh_.height)));
    const int rows = (count + columns - 1) / std::max(columns, 1);
    for (int i = 0; i < count; ++i) {
      const double w = mesh_.width / columns;
      const double h = mesh_.height / rows;
      const double x0 = (i % columns) * w;
      const double y0 = (i / columns) * h;
      KnotIndex last = add({x0 + 0.1 * w, y0 + uniform(0.2, 0.8) * h}, KnotKind::kVertex);
      for (int s = 1; s <= 4; ++s) {
        const KnotIndex next = add({x0 + (0.1 + 0.2 * s) * w, y0 + uniform(0.2, 0.8) * h}, KnotKind::kVertex);
        add_segment(last, next);
        last = next;
      }
    }
  }

  void add_sides(double spacing) {
    for (double x = spacing; x < mesh_.width - 1; x += spacing) {
      add({x, 0}, KnotKind::kBorder);
      add({x, mesh_.height}, KnotKind::kBorder);
    }
    for (double y = spacing; y < mesh_.height - 1; y += spacing) {
      add({0, y}, KnotKind::kBorder);
      add({mesh_.width, y}, KnotKind::kBorder);
    }
  }

  void add_free(int count) {
    while (count > 0) {
      const Vec2 p{uniform(1, mesh_.width - 1), uniform(1, mesh_.height - 1)};
      const double density = 0.1 + 0.9 * std::pow(std::sin(p.x * 0.013) * std::cos(p.y * 0.017), 2);
      if (uniform(0, 1) > density || too_close(p)) continue;
      add(p, KnotKind::kFree);
      --count;
    }
  }

  mesh::KnotMesh finish() {
    mesh::triangulate(mesh_);
    return mesh_;
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }

  KnotIndex add(Vec2 p, KnotKind kind) {
    const auto k = static_cast<KnotIndex>(mesh_.knots.size());
    mesh_.knots.push_back({p, kind, mesh::KnotId{k}});
    return k;
  }

  void add_segment(KnotIndex a, KnotIndex b) {
    const Vec2 from = mesh_.knots[a].position;
    const Vec2 d = mesh_.knots[b].position - from;
    const KnotIndex m1 = add(from + (1.0 / 3) * d, KnotKind::kSegment);
    const KnotIndex m2 = add(from + (2.0 / 3) * d, KnotKind::kSegment);
    mesh_.segments.push_back({{a, m1, m2, b}});
  }

  bool too_close(Vec2 p) const {
    const auto near = [&](const mesh::Knot& k) { return norm(k.position - p) < 1.5; };
    if (std::any_of(mesh_.knots.begin(), mesh_.knots.end(), near)) return true;
    return std::any_of(mesh_.segments.begin(), mesh_.segments.end(), [&](const mesh::FeatureSegment& s) {
      const Vec2 a = mesh_.knots[s.knots.front()].position;
      const Vec2 d = mesh_.knots[s.knots.back()].position - a;
      const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
      return norm(p - (a + t * d)) < 1;
    });
  }

  mesh::KnotMesh mesh_;
  std::mt19937_64 random_;
};

}  // namespace

mesh::KnotMesh picture_mesh(double width, double height, int free_knots, int features, std::uint64_t seed) {
  PictureMesh picture(width, height, seed);
  picture.add_features(features);
  picture.add_sides(std::sqrt(width * height / std::max(free_knots, 1)) * 1.5);
  picture.add_free(free_knots);
  return picture.finish();
}

}  // namespace knotreel::bench
