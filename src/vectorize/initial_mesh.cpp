// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/initial_mesh.h"

#include "knotreel/mesh/insert_polylines.h"
#include "knotreel/mesh/triangulate.h"

namespace knotreel::vectorize {

namespace {

using mesh::KnotIndex;
using mesh::KnotKind;

class Builder {
 public:
  Builder(const param::Parametrization& p, double spacing, double shortest)
      : spacing_(spacing), shortest_(shortest), mesh_(mesh::make_domain(p.width, p.height)) {
    vertices_.reserve(p.vertices.size());
    for (const param::PolylineVertex& v : p.vertices) vertices_.push_back(add(v.position, KnotKind::kVertex));
  }

  void add_polyline(const param::Polyline& line) {
    const std::size_t n = line.vertices.size();
    for (std::size_t i = 0; i + 1 < n + (line.closed ? 1 : 0); ++i) {
      add_segment(vertices_[line.vertices[i]], vertices_[line.vertices[(i + 1) % n]], n < 3);
    }
  }

  mesh::KnotMesh finish() {
    mesh::triangulate(mesh_);
    return std::move(mesh_);
  }

 private:
  KnotIndex add(Vec2 p, KnotKind kind) {
    const auto k = static_cast<KnotIndex>(mesh_.knots.size());
    mesh_.knots.push_back({p, kind, mesh::KnotId{k}});
    return k;
  }

  /// @param alone  it has no neighbour in its polyline, and ends that may be tips.
  void add_segment(KnotIndex from, KnotIndex to, bool alone) {
    const Vec2 a = mesh_.knots[from].position;
    const Vec2 b = mesh_.knots[to].position;
    const double length = norm(b - a);
    const int inside = !alone && length < shortest_ ? 0 : mesh::knots_inside_segment(length, spacing_);
    mesh::FeatureSegment segment{{from}};
    for (int i = 1; i <= inside; ++i) {
      segment.knots.push_back(add(a + (static_cast<double>(i) / (inside + 1)) * (b - a), KnotKind::kSegment));
    }
    segment.knots.push_back(to);
    mesh_.segments.push_back(std::move(segment));
  }

  double spacing_;
  double shortest_;
  mesh::KnotMesh mesh_;
  std::vector<KnotIndex> vertices_;
};

}  // namespace

mesh::KnotMesh initial_mesh(const param::Parametrization& parametrization, double spacing, double shortest) {
  Builder builder(parametrization, spacing, shortest);
  for (const param::Polyline& line : parametrization.polylines) builder.add_polyline(line);
  return builder.finish();
}

}  // namespace knotreel::vectorize
