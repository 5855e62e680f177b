// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/drawings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include "knotreel/spline/basis.h"

namespace knotreel::cli::debug {
namespace {

using mesh::KnotIndex;
using Edge = std::pair<KnotIndex, KnotIndex>;

constexpr Colour kWhite{255, 255, 255};
constexpr Colour kBlack{20, 20, 24};
constexpr Colour kGrey{140, 140, 148};
constexpr Colour kMeshLine{38, 78, 140};
constexpr Colour kFeature{214, 30, 50};
constexpr std::array<Colour, 6> kCurves{
    {{214, 30, 50}, {0, 114, 178}, {0, 140, 95}, {204, 95, 0}, {150, 60, 160}, {120, 85, 30}}};

Edge ordered(KnotIndex a, KnotIndex b) {
  return std::minmax(a, b);
}

/// Lines get thinner with the canvas, but never vanish.
double thin(const Canvas& canvas) {
  return std::clamp(canvas.scale() * 0.3, 0.7, 1.2);
}

void ringed_dot(Canvas& canvas, Vec2 at, double radius, Colour colour) {
  canvas.disc(at, radius + 1, kBlack);
  canvas.disc(at, radius, colour);
}

void curve(Canvas& canvas, const features::Chain& chain, double width, Colour colour) {
  const auto& points = chain.points;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    canvas.line(points[i].position, points[i + 1].position, width, colour);
  }
  if (chain.closed) canvas.line(points.back().position, points.front().position, width, colour);
}

/// Edges of a mesh, each once, with whether a feature runs along it.
struct MeshEdges {
  std::set<Edge> features;
  std::set<Edge> others;

  explicit MeshEdges(const mesh::KnotMesh& mesh) {
    for (const mesh::FeatureSegment& s : mesh.segments) {
      for (std::size_t i = 0; i + 1 < s.knots.size(); ++i)
        features.insert(ordered(s.knots[i], s.knots[i + 1]));
    }
    for (const mesh::Face& f : mesh.faces) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Edge e = ordered(f[i], f[(i + 1) % 3]);
        if (!features.contains(e)) others.insert(e);
      }
    }
  }
};

/// Draws knots at `places` and edges by `edge(from, to, width, colour)`.
template <class DrawEdge>
void draw_knots_and_edges(Canvas& canvas, const mesh::KnotMesh& mesh, std::span<const Vec2> places,
                          DrawEdge&& edge) {
  const MeshEdges edges(mesh);
  for (const Edge& e : edges.others) edge(e, thin(canvas), kMeshLine);
  for (const Edge& e : edges.features) edge(e, 2 * thin(canvas), kFeature);
  const double unit = std::clamp(canvas.scale() * 0.4, 0.6, 1.6);
  for (std::size_t k = 0; k < places.size(); ++k) {
    switch (mesh.knots[k].kind) {
      case mesh::KnotKind::kVertex:
        ringed_dot(canvas, places[k], 2 * unit, kWhite);
        break;
      case mesh::KnotKind::kSegment:
        canvas.disc(places[k], 1.5 * unit, kFeature);
        break;
      default:
        canvas.disc(places[k], 1.2 * unit, kMeshLine);
    }
  }
}

std::vector<Vec2> positions(const mesh::KnotMesh& mesh) {
  std::vector<Vec2> places;
  for (const mesh::Knot& k : mesh.knots) places.push_back(k.position);
  return places;
}

/// The geometry part of a surface: from the parametric domain to the picture.
class Geometry {
 public:
  explicit Geometry(const document::FrameModel& model) : model_(model), basis_(model.space) {}

  void move(std::vector<Vec2>& points) const {
    const spline::ScatteredValues at = basis_.evaluate(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t v = at.begin[i]; v < at.begin[i + 1]; ++v) {
        const auto group = model_.space->geometry_of()[at.values[v].function];
        points[i] = points[i] + at.values[v].value * model_.displacement[group];
      }
    }
  }

 private:
  const document::FrameModel& model_;
  spline::Basis basis_;
};

Colour control_colour(const document::FrameModel& model, std::size_t function) {
  const auto channels = static_cast<std::size_t>(model.channels);
  const auto at = [&](std::size_t c) {
    const double v = model.colour[function * channels + (channels >= 3 ? c : 0)];
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
  };
  return {at(0), at(1), at(2)};
}

/// What meshes are drawn on.
Canvas faded(const image::Image& picture, int scale) {
  return enlarged_by(scale > 0 ? scale : debug_scale(picture.width, picture.height), picture, 0.6, 0.8);
}

}  // namespace

Canvas draw_chains(const image::Image& picture, const features::FeatureChains& chains,
                   const features::FeatureChains* before) {
  Canvas canvas = enlarged(picture, 0.6, 0.4);
  if (before != nullptr) {
    for (const features::Chain& c : before->chains) curve(canvas, c, 2 * thin(canvas), kGrey);
  }
  const double dot = 0.4 * canvas.scale();
  for (std::size_t i = 0; i < chains.chains.size(); ++i) {
    const Colour colour = kCurves[i % kCurves.size()];
    curve(canvas, chains.chains[i], 1.4 * thin(canvas), colour);
    for (const auto& p : chains.chains[i].points) canvas.disc(p.position, dot, colour);
  }
  for (const features::Chain& c : chains.chains) {
    if (c.closed) continue;
    for (const auto* end : {&c.points.front(), &c.points.back()})
      ringed_dot(canvas, end->position, 2 * dot, kWhite);
  }
  return canvas;
}

Canvas draw_parametrization(const image::Image& picture, const param::Parametrization& p) {
  constexpr int kEvery = 8;
  Canvas canvas = enlarged(picture, 0.75, 0.5);
  const auto at = [&](int x, int y) {
    return p.parameter[std::size_t(y) * std::size_t(p.width) + std::size_t(x)];
  };
  for (int y = kEvery / 2; y < p.height; y += kEvery) {
    for (int x = 1; x < p.width; ++x) canvas.line(at(x - 1, y), at(x, y), thin(canvas), kMeshLine, 0.8);
  }
  for (int x = kEvery / 2; x < p.width; x += kEvery) {
    for (int y = 1; y < p.height; ++y) canvas.line(at(x, y - 1), at(x, y), thin(canvas), kMeshLine, 0.8);
  }
  for (const param::Polyline& line : p.polylines) {
    const std::size_t n = line.vertices.size();
    for (std::size_t i = 0; i + 1 < n + (line.closed ? 1 : 0); ++i) {
      canvas.line(p.vertices[line.vertices[i]].position, p.vertices[line.vertices[(i + 1) % n]].position,
                  2 * thin(canvas), kFeature);
    }
  }
  for (const param::PolylineVertex& v : p.vertices)
    ringed_dot(canvas, v.position, 0.7 * canvas.scale(), kWhite);
  return canvas;
}

Canvas draw_mesh(const image::Image& picture, const mesh::KnotMesh& mesh, int scale) {
  Canvas canvas = faded(picture, scale);
  const std::vector<Vec2> places = positions(mesh);
  draw_knots_and_edges(canvas, mesh, places, [&](const Edge& e, double width, Colour colour) {
    canvas.line(places[e.first], places[e.second], width, colour);
  });
  return canvas;
}

Canvas draw_mapped_mesh(const image::Image& picture, const document::FrameModel& model, int scale) {
  const mesh::KnotMesh& mesh = model.space->mesh();
  const bool moved =
      std::any_of(model.displacement.begin(), model.displacement.end(), [](Vec2 d) { return d != Vec2{}; });
  if (!moved) return draw_mesh(picture, mesh, scale);
  Canvas canvas = faded(picture, scale);
  const Geometry geometry(model);
  std::vector<Vec2> places = positions(mesh);
  geometry.move(places);
  draw_knots_and_edges(canvas, mesh, places, [&](const Edge& e, double width, Colour colour) {
    const Vec2 a = mesh.knots[e.first].position;
    const Vec2 b = mesh.knots[e.second].position;
    const int pieces = std::clamp(static_cast<int>(norm(b - a) / 2), 2, 64);
    std::vector<Vec2> points;
    for (int i = 0; i <= pieces; ++i) points.push_back(a + (double(i) / pieces) * (b - a));
    geometry.move(points);
    for (std::size_t i = 1; i < points.size(); ++i) canvas.line(points[i - 1], points[i], width, colour);
  });
  return canvas;
}

Canvas draw_control_net(const image::Image& picture, const document::FrameModel& model) {
  const spline::SplineSpace& space = *model.space;
  std::vector<Vec2> sites = space.geometry_greville();
  for (std::size_t g = 0; g < sites.size(); ++g) sites[g] = sites[g] + model.displacement[g];
  const auto group = space.geometry_of();

  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const spline::Config& config : space.configs()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = config.functions[i];
      const auto b = config.functions[(i + 1) % 3];
      if (a == spline::kNoFunction || b == spline::kNoFunction || group[a] == group[b]) continue;
      edges.insert(std::minmax(group[a], group[b]));
    }
  }
  Canvas canvas = enlarged(picture, 0.55, 0.6);
  for (const auto& [a, b] : edges) canvas.line(sites[a], sites[b], thin(canvas), kMeshLine, 0.8);
  const double radius = std::clamp(0.55 * canvas.scale(), 0.8, 3.0);
  for (std::size_t f = 0; f < space.function_count(); ++f) {
    ringed_dot(canvas, sites[group[f]], radius, control_colour(model, f));
  }
  return canvas;
}

}  // namespace knotreel::cli::debug
