// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/redraw_mesh.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "knotreel/mesh/triangulate.h"

namespace knotreel::track {
namespace {

using mesh::KnotId;
using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

constexpr double kSamePlace = 2.5;  // pixels between a vertex and where the one before should be
constexpr double kLeastLeft = 0.5;  // of a segment, if it keeps the knots inside
constexpr double kFlat = 1e-3;      // height of a face, pixels
constexpr double kCell = 8;         // of the grids that near things are found by, pixels

/// Things by the cells of a grid that they reach.
class Grid {
 public:
  Grid(double width, double height)
      : columns_(std::size_t(width / kCell) + 1),
        rows_(std::size_t(height / kCell) + 1),
        cells_(columns_ * rows_) {}

  void add(Vec2 low, Vec2 high, std::uint32_t thing) {
    each(low, high, [&](std::vector<std::uint32_t>& cell) { cell.push_back(thing); });
  }
  /// Some more than once.
  template <typename Visit>
  void near(Vec2 p, double distance, const Visit& visit) {
    each(p - Vec2{distance, distance}, p + Vec2{distance, distance},
         [&](const std::vector<std::uint32_t>& cell) {
           for (const std::uint32_t thing : cell) visit(thing);
         });
  }

 private:
  template <typename Each>
  void each(Vec2 low, Vec2 high, const Each& act) {
    const auto index = [](double v, std::size_t count) {
      return std::min(static_cast<std::size_t>(std::max(0.0, v / kCell)), count - 1);
    };
    for (std::size_t row = index(low.y, rows_); row <= index(high.y, rows_); ++row) {
      for (std::size_t column = index(low.x, columns_); column <= index(high.x, columns_); ++column)
        act(cells_[row * columns_ + column]);
    }
  }

  std::size_t columns_;
  std::size_t rows_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

bool has_flat_face(const KnotMesh& mesh) {
  return std::any_of(mesh.faces.begin(), mesh.faces.end(), [&](const mesh::Face& face) {
    const Vec2 a = mesh.knots[face[0]].position;
    const Vec2 b = mesh.knots[face[1]].position;
    const Vec2 c = mesh.knots[face[2]].position;
    return 2 * signed_area(a, b, c) < kFlat * std::max({norm(b - a), norm(c - b), norm(a - c)});
  });
}

using Ends = std::pair<std::uint32_t, std::uint32_t>;  ///< ids

class Redrawing {
 public:
  Redrawing(const KnotMesh& features, const KnotMesh& before, std::span<const Vec2> targets,
            std::uint32_t& next_id)
      : before_(before),
        targets_(targets),
        next_id_(next_id),
        mesh_(features),
        pieces_(features.width, features.height),
        knots_(features.width, features.height) {
    mesh_.faces.clear();
  }

  KnotMesh mesh(const CarryOptions& options, CarryReport& report) {
    name_vertices();
    fill_segments();
    take_places();
    add_free_knots(options.min_distance, report);
    mesh::triangulate(mesh_);
    return std::move(mesh_);
  }

 private:
  /// A vertex of the new mesh, and one of that before that should be near by.
  struct Pair {
    double distance;
    KnotIndex knot;
    KnotIndex old;
  };

  std::vector<Pair> near_vertices() const {
    Grid grid(mesh_.width, mesh_.height);
    for (KnotIndex k = 0; k < before_.knots.size(); ++k) {
      if (before_.knots[k].kind == KnotKind::kVertex) grid.add(targets_[k], targets_[k], k);
    }
    std::vector<Pair> pairs;
    for (KnotIndex k = 0; k < mesh_.knots.size(); ++k) {
      if (mesh_.knots[k].kind != KnotKind::kVertex) continue;
      const Vec2 p = mesh_.knots[k].position;
      grid.near(p, kSamePlace, [&](KnotIndex old) {
        const double distance = norm(targets_[old] - p);
        if (distance <= kSamePlace) pairs.push_back({distance, k, old});
      });
    }
    return pairs;
  }

  /// Vertices get the names of those before, the nearest first.
  void name_vertices() {
    std::vector<Pair> pairs = near_vertices();
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.distance, a.knot, a.old) < std::tie(b.distance, b.knot, b.old);
    });
    std::vector<bool> named(mesh_.knots.size(), false);
    std::vector<bool> used(before_.knots.size(), false);
    for (const Pair& pair : pairs) {
      if (named[pair.knot] || used[pair.old]) continue;
      named[pair.knot] = used[pair.old] = true;
      mesh_.knots[pair.knot].id = before_.knots[pair.old].id;
    }
    for (KnotIndex k = 0; k < mesh_.knots.size(); ++k) {
      if (mesh_.knots[k].kind == KnotKind::kVertex && !named[k]) mesh_.knots[k].id = new_id();
    }
  }

  static Ends ends_of(const KnotMesh& mesh, const mesh::FeatureSegment& s) {
    return {static_cast<std::uint32_t>(mesh.knots[s.knots.front()].id),
            static_cast<std::uint32_t>(mesh.knots[s.knots.back()].id)};
  }

  /// Segments between the same vertices as before have the knots that they had inside, which have settled.
  void fill_segments() {
    std::map<Ends, std::vector<KnotIndex>> known;
    for (const mesh::FeatureSegment& s : before_.segments) known.emplace(ends_of(before_, s), s.knots);
    for (mesh::FeatureSegment& s : mesh_.segments) {
      const Ends ends = ends_of(mesh_, s);
      auto found = known.find(ends);
      if (found == known.end()) {
        found = known.find({ends.second, ends.first});
        if (found != known.end()) std::reverse(found->second.begin(), found->second.end());
      }
      if (found != known.end() && may_carry(found->second, s)) {
        carry_inside(found->second, s);
      } else {
        for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) mesh_.knots[s.knots[i]].id = new_id();
      }
    }
  }

  /// @param old knots of the segment before: as many as there should be, or more, but not in a heap.
  bool may_carry(const std::vector<KnotIndex>& old, const mesh::FeatureSegment& s) const {
    const double length = norm(mesh_.knots[s.knots.back()].position - mesh_.knots[s.knots.front()].position);
    return old.size() >= s.knots.size() && length > kLeastLeft * norm(was(old.back()) - was(old.front()));
  }

  void carry_inside(const std::vector<KnotIndex>& old, mesh::FeatureSegment& s) {
    const Vec2 a = mesh_.knots[s.knots.front()].position;
    const Vec2 b = mesh_.knots[s.knots.back()].position;
    const Vec2 old_a = was(old.front());
    const Vec2 old_b = was(old.back());
    const bool rests = a == old_a && b == old_b;
    const KnotIndex last = s.knots.back();
    s.knots.pop_back();
    for (std::size_t i = 1; i + 1 < old.size(); ++i) {
      if (i == s.knots.size()) {
        s.knots.push_back(static_cast<KnotIndex>(mesh_.knots.size()));
        mesh_.knots.push_back({});
      }
      const double share = norm(was(old[i]) - old_a) / norm(old_b - old_a);
      mesh_.knots[s.knots[i]] = {rests ? was(old[i]) : a + share * (b - a), KnotKind::kSegment,
                                 before_.knots[old[i]].id};
    }
    s.knots.push_back(last);
  }

  Vec2 was(KnotIndex k) const { return before_.knots[k].position; }

  /// What new knots have to keep away from.
  void take_places() {
    for (std::uint32_t s = 0; s < mesh_.segments.size(); ++s) {
      const auto [a, b] = segment(s);
      // Long ones in pieces, so that they do not reach all cells of their box.
      const int count = 1 + static_cast<int>(norm(b - a) / (2 * kCell));
      for (int i = 0; i < count; ++i) {
        const Vec2 p = a + (static_cast<double>(i) / count) * (b - a);
        const Vec2 q = a + (static_cast<double>(i + 1) / count) * (b - a);
        pieces_.add({std::min(p.x, q.x), std::min(p.y, q.y)}, {std::max(p.x, q.x), std::max(p.y, q.y)}, s);
      }
    }
    for (KnotIndex k = 0; k < mesh_.knots.size(); ++k)
      knots_.add(mesh_.knots[k].position, mesh_.knots[k].position, k);
  }

  std::pair<Vec2, Vec2> segment(std::uint32_t s) const {
    const std::vector<KnotIndex>& knots = mesh_.segments[s].knots;
    return {mesh_.knots[knots.front()].position, mesh_.knots[knots.back()].position};
  }

  bool has_room(Vec2 p, KnotKind kind, double least) {
    const double inset = kind == KnotKind::kFree ? least : 0;
    bool room = p.x >= inset && p.y >= inset && p.x <= mesh_.width - inset && p.y <= mesh_.height - inset;
    if (!room) return false;
    pieces_.near(p, least, [&](std::uint32_t s) {
      const auto [a, b] = segment(s);
      room = room && distance_to_segment(p, a, b) >= least;
    });
    knots_.near(p, least,
                [&](KnotIndex other) { room = room && norm(mesh_.knots[other].position - p) >= least; });
    return room;
  }

  void add_free_knots(double least, CarryReport& report) {
    for (KnotIndex k = 0; k < before_.knots.size(); ++k) {
      const KnotKind kind = before_.knots[k].kind;
      if (kind != KnotKind::kFree && kind != KnotKind::kBorder) continue;
      const Vec2 p = targets_[k];
      if (!has_room(p, kind, least)) {
        ++report.removed;
        continue;
      }
      report.moved += p != before_.knots[k].position ? 1 : 0;
      knots_.add(p, p, static_cast<KnotIndex>(mesh_.knots.size()));
      mesh_.knots.push_back({p, kind, before_.knots[k].id});
    }
  }

  KnotId new_id() { return KnotId{next_id_++}; }

  const KnotMesh& before_;
  std::span<const Vec2> targets_;
  std::uint32_t& next_id_;
  KnotMesh mesh_;
  Grid pieces_;  ///< of segments
  Grid knots_;
};

}  // namespace

std::optional<KnotMesh> redraw_mesh(const KnotMesh& features, const KnotMesh& before,
                                    std::span<const Vec2> targets, const CarryOptions& options,
                                    std::uint32_t& next_id, CarryReport& report) {
  KnotMesh mesh = Redrawing(features, before, targets, next_id).mesh(options, report);
  if (has_flat_face(mesh)) return std::nullopt;
  return mesh;
}

}  // namespace knotreel::track
