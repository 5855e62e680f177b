// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/descend.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/triangle.h"
#include "knotreel/fit/knot_gradient.h"
#include "knotreel/mesh/edge_lengths.h"

namespace knotreel::fit {

namespace {

using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

/// A triangle that must stay positive while knots move: a face of the mesh, or of a link.
struct Guard {
  std::array<KnotIndex, 3> knots;
  double least_height;  ///< over its longest side, pixels
};

class Guards {
 public:
  Guards(const spline::SplineSpace& space, const KnotMesh& mesh, double min_distance)
      : at_rest_(mesh.knots.size()) {
    for (const mesh::Face& f : mesh.faces) add(mesh, f, 0.25 * min_distance);
    for (const spline::Config& c : space.configs()) {
      const auto knot = [&](std::size_t i) { return space.cut().corners[c.triangle[i]].knot; };
      add(mesh, {knot(0), knot(1), knot(2)}, 0.05);
    }
  }

  /// Shrinks moves until no triangle is flatter than it may be.
  void limit(const KnotMesh& mesh, std::vector<Vec2>& moves) const {
    // Ends, because knots at rest break no guard, and later attempts put all knots of bad triangles to rest.
    for (int attempt = 0;; ++attempt) {
      std::vector<bool> bad(mesh.knots.size(), false);
      bool any = false;
      for (const Guard& g : guards_) {
        if (height(mesh, g.knots, moves) >= g.least_height) continue;
        any = true;
        for (const KnotIndex k : g.knots) bad[k] = true;
      }
      if (!any) return;
      for (KnotIndex k = 0; k < bad.size(); ++k) {
        if (bad[k]) moves[k] = attempt < 4 ? 0.5 * moves[k] : Vec2{};
      }
    }
  }

 private:
  static double height(const KnotMesh& mesh, const std::array<KnotIndex, 3>& t,
                       const std::vector<Vec2>& moves) {
    const auto corner = [&](std::size_t i) { return mesh.knots[t[i]].position + moves[t[i]]; };
    return height_over_longest({corner(0), corner(1), corner(2)});
  }

  void add(const KnotMesh& mesh, const std::array<KnotIndex, 3>& t, double least_height) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return;
    const double now = height(mesh, t, at_rest_);
    // Flat triangles of collinear knots stay flat.
    if (now < 1e-6) return;
    // What is flatter already must not get any flatter; a share of it would let it shrink to nothing in many
    // steps.
    guards_.push_back({t, std::min(least_height, now * (1 - 1e-12))});
  }

  std::vector<Vec2> at_rest_;
  std::vector<Guard> guards_;
};

// Factors of a step while the gradient of its knot keeps its direction, and when it turns.
constexpr double kGrow = 1.2;
constexpr double kShrink = 0.6;

/// Step lengths of the knots, each adapted to how its gradient turns.
class Steps {
 public:
  Steps(const KnotMesh& mesh, double share)
      : lengths_(mesh::shortest_edges(mesh)), before_(mesh.knots.size()) {
    for (double& l : lengths_) l *= share;
  }

  std::vector<Vec2> moves(const std::vector<Vec2>& gradient, const std::vector<double>& shortest) {
    std::vector<Vec2> result(gradient.size());
    for (std::size_t k = 0; k < gradient.size(); ++k) {
      const double length = norm(gradient[k]);
      if (!(length > 0)) continue;
      const Vec2 direction = (-1 / length) * gradient[k];
      const double turn = dot(direction, before_[k]);
      lengths_[k] *= turn > 0.5 ? kGrow : turn < 0 ? kShrink : 1.0;
      lengths_[k] = std::min(lengths_[k], 0.3 * shortest[k]);
      before_[k] = direction;
      result[k] = lengths_[k] * direction;
    }
    return result;
  }

 private:
  std::vector<double> lengths_;
  std::vector<Vec2> before_;
};

/// By knot, whether it may move.
std::vector<std::uint8_t> movable(const KnotMesh& mesh, bool along_curves) {
  std::vector<std::uint8_t> wanted(mesh.knots.size());
  for (KnotIndex k = 0; k < wanted.size(); ++k) {
    wanted[k] = along_curves || mesh.knots[k].kind != KnotKind::kSegment;
  }
  return wanted;
}

}  // namespace

std::vector<Vec2> moved_positions(const mesh::KnotMesh& mesh, const std::vector<Vec2>& moves) {
  std::vector<Vec2> positions(mesh.knots.size());
  for (KnotIndex k = 0; k < positions.size(); ++k) {
    const Vec2 old = mesh.knots[k].position;
    Vec2& p = positions[k];
    p = old + moves[k];
    if (mesh.knots[k].kind != KnotKind::kBorder) continue;
    if (old.x == 0 || old.x == mesh.width) p.x = old.x;
    if (old.y == 0 || old.y == mesh.height) p.y = old.y;
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 from = mesh.knots[s.knots.front()].position;
    const Vec2 along = mesh.knots[s.knots.back()].position - from;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      Vec2& p = positions[s.knots[i]];
      p = from + (dot(p - from, along) / dot(along, along)) * along;
    }
  }
  return positions;
}

void limit_moves(const spline::SplineSpace& space, const mesh::KnotMesh& mesh, double min_distance,
                 std::vector<Vec2>& moves) {
  Guards(space, mesh, min_distance).limit(mesh, moves);
}

ColourSurface descend(ColourSurface start, const Pixels& pixels, const DescentOptions& options,
                      std::unique_ptr<const SpaceAtPixels> at_pixels) {
  ColourSurface best = start;
  ColourSurface at = std::move(start);
  Steps steps(at.space->mesh(), options.first_step);
  const std::vector<std::uint8_t> wanted = movable(at.space->mesh(), options.along_curves);
  for (int i = 0; i < options.steps; ++i) {
    if (options.on_step) options.on_step();
    if (!at_pixels) at_pixels = std::make_unique<const SpaceAtPixels>(at.space, pixels);
    ColourFitOptions colour = options.colour;
    colour.start = at.fit.control;  // the functions stay, and hardly move
    const KnotMesh& mesh = at.space->mesh();
    std::vector<Vec2> moves =
        steps.moves(knot_gradient(at_pixels->values, pixels, at.fit, wanted), mesh::shortest_edges(mesh));
    limit_moves(*at.space, mesh, options.min_distance, moves);
    at.space = std::make_shared<const spline::SplineSpace>(at.space->moved(moved_positions(mesh, moves)));
    at_pixels.reset();  // each takes as much memory as a few copies of the picture
    at_pixels = std::make_unique<const SpaceAtPixels>(at.space, pixels);
    at.fit = fit_colours(at_pixels->values, pixels, colour);
    if (at.fit.squared_error < best.fit.squared_error) best = at;
  }
  return best;
}

}  // namespace knotreel::fit
