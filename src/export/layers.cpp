// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/layers.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace knotreel::exporting {

namespace {

// How far a layer reaches over its edge, in pixels of the picture. Where a viewer's pixel is crossed by a
// feature, its centre is up to 0.71 pixels off the curve: 2 px serve pictures that are shown at a third of
// their size and more.
constexpr double kReach = 2;

using mesh::HalfEdges;

bool before(const Rim& a, const Rim& b) {
  const auto key = [](const Rim& r) {
    return std::tuple(r.own_colour, r.along, r.half_edge, r.source, r.shown);
  };
  return key(a) < key(b);
}

bool equal(const Rim& a, const Rim& b) {
  return !before(a, b) && !before(b, a);
}

class RimFinder {
 public:
  explicit RimFinder(const Sheets& sheets) : sheets_(sheets), layer_(assign_layers(sheets)) {}

  std::vector<Layer> run() {
    std::vector<Layer> layers(1 + *std::max_element(layer_.begin(), layer_.end()));
    for (std::uint32_t f = 0; f < layer_.size(); ++f) {
      Layer& layer = layers[layer_[f]];
      layer.faces.push_back(f);
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        add_edge_rim(h, layer.rims);
        add_rims_around(h, layer.rims);
      }
    }
    for (std::size_t l = 1; l < layers.size(); ++l) {
      layers[0].underlay.insert(layers[0].underlay.end(), layers[l].faces.begin(), layers[l].faces.end());
    }
    for (Layer& layer : layers) {
      auto& rims = layer.rims;
      // Colours of other sides first, the surface itself over them: a layer is as right as it can be.
      std::sort(rims.begin(), rims.end(), before);
      rims.erase(std::unique(rims.begin(), rims.end(), equal), rims.end());
    }
    return layers;
  }

 private:
  void add_edge_rim(std::uint32_t h, std::vector<Rim>& rims) const {
    const std::uint32_t o = sheets_.opposite(h);
    if (o == kNoHalfEdge) {
      rims.push_back({h, true, true, 0, true});
      return;
    }
    if (layer_[o / 3] == layer_[h / 3]) return;
    rims.push_back({o, true, !sheets_.is_feature(h), 0, layer_[o / 3] > layer_[h / 3]});
  }

  /// In the other faces around the origin of h: of its own fan, and of the fans beyond the walls of its face.
  void add_rims_around(std::uint32_t h, std::vector<Rim>& rims) const {
    const std::uint32_t own = layer_[h / 3];
    const CornerIndex c = sheets_.origin(h);
    const auto add_fan = [&](CornerIndex fan, bool own_colour) {
      for (const std::uint32_t g : sheets_.around(fan)) {
        const std::uint32_t other = layer_[g / 3];
        if (other != own) rims.push_back({g, false, own_colour, own_colour ? 0 : c, other > own});
      }
    };
    // All faces of the fan and of the layer ask for the same.
    const auto around = sheets_.around(c);
    const auto first =
        std::find_if(around.begin(), around.end(), [&](std::uint32_t g) { return layer_[g / 3] == own; });
    if (*first == h) add_fan(c, true);
    if (sheets_.is_feature(h)) {
      const CornerIndex beyond = sheets_.target(sheets_.opposite(h));
      if (beyond != c) add_fan(beyond, false);
    }
    const std::uint32_t last = HalfEdges::previous(h);
    if (sheets_.is_feature(last)) {
      const CornerIndex beyond = sheets_.origin(sheets_.opposite(last));
      if (beyond != c) add_fan(beyond, false);
    }
  }

  const Sheets& sheets_;
  std::vector<std::uint32_t> layer_;
};

/// The share of the way from an edge or corner across a face that makes kReach, given the distance across and
/// whether something that must not be touched lies at the far end.
double share_of(double across, bool free_end) {
  return std::min(free_end ? 1.0 : 0.5, kReach / std::max(across, 1e-9));
}

double height_over(Vec2 p, Vec2 a, Vec2 b) {
  return std::abs(cross(b - a, p - a)) / std::max(norm(b - a), 1e-9);
}

bool on_feature(const Sheets& sheets, CornerIndex c) {
  const auto around = sheets.around(c);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t h) {
    return sheets.is_feature(h) || sheets.is_feature(HalfEdges::previous(h));
  });
}

/// Inner side of a rim along an edge: where the parameter t of the edge goes.
Vec2 towards_apex(const Sheets& sheets, std::uint32_t h, Vec2 u) {
  const CornerIndex apex = sheets.origin(HalfEdges::previous(h));
  const Vec2 p = sheets.parameter(apex);
  const double across =
      height_over(p, sheets.parameter(sheets.origin(h)), sheets.parameter(sheets.target(h)));
  return u + share_of(across, !on_feature(sheets, apex)) * (p - u);
}

/// The two far points of a rim around the origin of h.
std::array<Vec2, 2> legs(const Sheets& sheets, std::uint32_t h) {
  const CornerIndex first = sheets.target(h);
  const CornerIndex second = sheets.origin(HalfEdges::previous(h));
  const Vec2 v = sheets.parameter(sheets.origin(h));
  const Vec2 p = sheets.parameter(first);
  const Vec2 q = sheets.parameter(second);
  const double share = share_of(height_over(v, p, q), false);
  return {v + share * (p - v), v + share * (q - v)};
}

/// The strip outside a border edge: the colour of the border goes on.
Patch outer_patch(const Tessellator& tessellator, std::uint32_t h) {
  const Sheets& sheets = tessellator.sheets();
  const Vec2 along = sheets.parameter(sheets.target(h)) - sheets.parameter(sheets.origin(h));
  const Vec2 out = (kReach / norm(along)) * Vec2{along.y, -along.x};
  Patch patch;
  for (const double t : tessellator.edge_parameters(h)) {
    const SurfacePoint edge = sheets.on_edge(h, t);
    patch.vertices.push_back(edge);
    patch.vertices.push_back({edge.u, edge.x + out, edge.colour});
  }
  return patch;
}

/// The colour of the other side of a feature, drawn across it in the image. It may reach over what belongs to
/// others: faces are painted later, and masks show no more than rim_outline(). Both ends go on straight, for
/// the pixels around bends.
Patch drawn_across(const Tessellator& tessellator, std::uint32_t h) {
  const Sheets& sheets = tessellator.sheets();
  std::vector<SurfacePoint> points;
  for (const double t : tessellator.edge_parameters(h)) {
    points.push_back(sheets.on_edge(sheets.opposite(h), 1 - t));
  }
  const std::size_t last = points.size() - 1;
  Patch patch;
  const auto add = [&](SurfacePoint point, Vec2 x, Vec2 across) {
    point.x = x;
    patch.vertices.push_back(point);
    point.x = x + across;
    patch.vertices.push_back(point);
  };
  for (std::size_t i = 0; i <= last; ++i) {
    const Vec2 d = points[std::min(i + 1, last)].x - points[i > 0 ? i - 1 : 0].x;
    const Vec2 along = (kReach / std::max(norm(d), 1e-9)) * d;
    const Vec2 across{-along.y, along.x};
    if (i == 0) add(points[i], points[i].x - along, across);
    add(points[i], points[i].x, across);
    if (i == last) add(points[i], points[i].x + along, across);
  }
  return patch;
}

void join_strip(Patch& patch, bool outside) {
  for (std::uint32_t i = 0; i + 2 < patch.vertices.size(); i += 2) {
    if (outside) {
      patch.triangles.push_back({i, i + 1, i + 2});
      patch.triangles.push_back({i + 1, i + 3, i + 2});
    } else {
      patch.triangles.push_back({i, i + 2, i + 1});
      patch.triangles.push_back({i + 1, i + 2, i + 3});
    }
  }
}

Patch edge_patch(const Tessellator& tessellator, const Rim& rim) {
  const Sheets& sheets = tessellator.sheets();
  if (sheets.opposite(rim.half_edge) == kNoHalfEdge) {
    Patch patch = outer_patch(tessellator, rim.half_edge);
    join_strip(patch, true);
    return patch;
  }
  const auto& face = sheets.faces()[rim.half_edge / 3];
  const Vec2 centre =
      (1.0 / 3) * (sheets.parameter(face[0]) + sheets.parameter(face[1]) + sheets.parameter(face[2]));
  Patch patch;
  for (const double t : tessellator.edge_parameters(rim.half_edge)) {
    const SurfacePoint edge = rim.own_colour ? sheets.on_edge(rim.half_edge, t)
                                             : sheets.on_edge(sheets.opposite(rim.half_edge), 1 - t);
    const Vec2 u = towards_apex(sheets, rim.half_edge, edge.u);
    // An end may lie on a feature, where only this face knows the side.
    SurfacePoint inner = sheets.at(u, centre - u);
    if (!rim.own_colour) inner.colour = edge.colour;
    patch.vertices.push_back(edge);
    patch.vertices.push_back(inner);
  }
  join_strip(patch, false);
  return patch;
}

Loop polygon(const std::vector<Vec2>& points) {
  Loop loop;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 a = points[i];
    const Vec2 b = points[(i + 1) % points.size()];
    loop.push_back({a, a, b, b});
  }
  return loop;
}

/// Image of a half edge from its origin to its target: exact for features, else by chords.
void append_edge(const Tessellator& tessellator, std::uint32_t h, Loop& loop) {
  const Sheets& sheets = tessellator.sheets();
  if (sheets.is_feature(h)) {
    loop.push_back(sheets.curve(h));
    return;
  }
  const std::vector<double> parameters = tessellator.edge_parameters(h);
  for (std::size_t i = 1; i < parameters.size(); ++i) {
    const Vec2 a = sheets.on_edge(h, parameters[i - 1]).x;
    const Vec2 b = sheets.on_edge(h, parameters[i]).x;
    loop.push_back({a, a, b, b});
  }
}

Loop rim_outline(const Tessellator& tessellator, const Rim& rim) {
  const Sheets& sheets = tessellator.sheets();
  if (!rim.along) {
    const Patch patch = rim_patch(tessellator, rim);
    return polygon({patch.vertices[0].x, patch.vertices[1].x, patch.vertices[2].x});
  }
  Loop loop;
  append_edge(tessellator, rim.half_edge, loop);
  const Patch patch = edge_patch(tessellator, rim);
  Vec2 from = loop.back()[3];
  const auto line_to = [&](Vec2 to) {
    loop.push_back({from, from, to, to});
    from = to;
  };
  for (std::size_t i = patch.vertices.size(); i >= 2; i -= 2) line_to(patch.vertices[i - 1].x);
  line_to(sheets.on_edge(rim.half_edge, 0).x);
  if (sheets.opposite(rim.half_edge) != kNoHalfEdge) return loop;
  // It lies on the other side of its half edge: turned, so that all loops go round the same way.
  std::reverse(loop.begin(), loop.end());
  for (Curve& curve : loop) std::reverse(curve.begin(), curve.end());
  return loop;
}

/// Half edges between a layer's faces and everything else, put together to loops.
std::vector<std::vector<std::uint32_t>> boundary_loops(const Sheets& sheets, const Layer& layer) {
  const auto inside = [&](std::uint32_t h) {
    return h != kNoHalfEdge && std::binary_search(layer.faces.begin(), layer.faces.end(), h / 3);
  };
  const auto knot = [&](CornerIndex c) { return sheets.model().space->cut().corners[c].knot; };
  std::multimap<mesh::KnotIndex, std::uint32_t> open;
  for (const std::uint32_t f : layer.faces) {
    for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      if (!inside(sheets.opposite(h))) open.emplace(knot(sheets.origin(h)), h);
    }
  }
  std::vector<std::vector<std::uint32_t>> loops;
  while (!open.empty()) {
    loops.emplace_back();
    for (auto next = open.begin(); next != open.end();) {
      const std::uint32_t h = next->second;
      open.erase(next);
      loops.back().push_back(h);
      // As many half edges begin at a knot as end there, so a walk ends where it began.
      next = open.find(knot(sheets.target(h)));
    }
  }
  return loops;
}

}  // namespace

std::vector<Layer> make_layers(const Sheets& sheets) {
  return RimFinder(sheets).run();
}

Patch rim_patch(const Tessellator& tessellator, const Rim& rim) {
  if (rim.along && !rim.own_colour) {
    Patch patch = drawn_across(tessellator, rim.half_edge);
    join_strip(patch, false);
    return patch;
  }
  if (rim.along) return edge_patch(tessellator, rim);
  const Sheets& sheets = tessellator.sheets();
  const CornerIndex c = sheets.origin(rim.half_edge);
  const auto [first, second] = legs(sheets, rim.half_edge);
  // A leg may run along a feature, where only this face knows the side.
  const Vec2 centre = (1.0 / 3) * (first + second + sheets.parameter(c));
  Patch patch;
  patch.vertices = {sheets.at_corner(c), sheets.at(first, centre - first),
                    sheets.at(second, centre - second)};
  if (!rim.own_colour) {
    for (SurfacePoint& v : patch.vertices) v.colour = sheets.at_corner(rim.source).colour;
  }
  patch.triangles = {{0, 1, 2}};
  return patch;
}

std::vector<Loop> layer_outline(const Tessellator& tessellator, const Layer& layer) {
  std::vector<Loop> outline;
  for (const auto& half_edges : boundary_loops(tessellator.sheets(), layer)) {
    outline.emplace_back();
    for (const std::uint32_t h : half_edges) append_edge(tessellator, h, outline.back());
  }
  for (const Rim& rim : layer.rims) {
    if (rim.shown) outline.push_back(rim_outline(tessellator, rim));
  }
  return outline;
}

}  // namespace knotreel::exporting
