// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/insert_polylines.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "knotreel/mesh/predicates.h"

namespace knotreel::mesh {

namespace {

constexpr double kOnEdge = 0.01;      // knots nearer to an edge are put on it, pixels
constexpr double kSharpest = 0.5;     // cosine between pieces that meet, reversed: 60 degrees
constexpr double kShortest = 2;       // piece of a polyline, pixels
constexpr int kFlipsPerCrossing = 8;  // far more than it takes; no way to loop for ever

struct Piece {
  Vec2 a;
  Vec2 b;
};

double distance(Vec2 p, const Piece& s) {
  return distance_to_segment(p, s.a, s.b);
}

bool cross(const Piece& s, const Piece& t) {
  return orientation(s.a, s.b, t.a) * orientation(s.a, s.b, t.b) <= 0 &&
         orientation(t.a, t.b, s.a) * orientation(t.a, t.b, s.b) <= 0;
}

double distance(const Piece& s, const Piece& t) {
  if (cross(s, t)) return 0;
  return std::min({distance(s.a, t), distance(s.b, t), distance(t.a, s), distance(t.b, s)});
}

std::vector<Piece> pieces_of(const std::vector<Vec2>& line) {
  std::vector<Piece> pieces;
  for (std::size_t i = 1; i < line.size(); ++i) pieces.push_back({line[i - 1], line[i]});
  return pieces;
}

class Inserter {
 public:
  Inserter(EditableMesh& mesh, const InsertOptions& options) : mesh_(mesh), options_(options) {
    for (const FeatureSegment& s : mesh.segments()) {
      taken_.push_back({mesh.position(s.knots.front()), mesh.position(s.knots.back())});
    }
  }

  std::vector<KnotIndex> insert(const std::vector<Vec2>& line) {
    const std::vector<Piece> pieces = pieces_of(line);
    if (pieces.empty() || !has_room(pieces) || !keeps_off_itself(pieces)) return {};
    const EditableMesh before = mesh_;
    const std::optional<std::vector<KnotIndex>> vertices = try_insert(line, pieces);
    if (!vertices) {
      mesh_ = before;
      return {};
    }
    taken_.insert(taken_.end(), pieces.begin(), pieces.end());
    return with_simple_knots(*vertices);
  }

 private:
  bool has_room(const std::vector<Piece>& pieces) const {
    const double least = options_.clearance;
    const auto inside = [&](Vec2 p) {
      return p.x >= least && p.y >= least && p.x <= mesh_.width() - least && p.y <= mesh_.height() - least;
    };
    return std::all_of(pieces.begin(), pieces.end(), [&](const Piece& p) {
      return inside(p.a) && inside(p.b) && std::all_of(taken_.begin(), taken_.end(), [&](const Piece& t) {
               return distance(p, t) >= least;
             });
    });
  }

  bool keeps_off_itself(const std::vector<Piece>& pieces) const {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Vec2 along = pieces[i].b - pieces[i].a;
      if (norm(along) < kShortest) return false;
      if (i > 0) {
        const Vec2 before = pieces[i - 1].b - pieces[i - 1].a;
        if (dot(before, along) < -kSharpest * norm(before) * norm(along)) return false;
      }
      for (std::size_t j = 0; j + 1 < i; ++j) {
        const double far = j + 2 == i ? 0.5 * norm(pieces[j + 1].b - pieces[j + 1].a) : options_.clearance;
        if (distance(pieces[i], pieces[j]) < std::min(far, options_.clearance)) return false;
      }
    }
    return true;
  }

  std::optional<std::vector<KnotIndex>> try_insert(const std::vector<Vec2>& line,
                                                   const std::vector<Piece>& pieces) {
    make_room(pieces);
    std::vector<KnotIndex> vertices;
    for (const Vec2 p : line) {
      const std::optional<KnotIndex> k = insert_knot(p);
      if (!k) return std::nullopt;
      mesh_.legalise_around(*k);
      vertices.push_back(*k);
    }
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      if (!join(vertices[i - 1], vertices[i])) return std::nullopt;
      mesh_.make_segment(vertices[i - 1], vertices[i]);
    }
    return vertices;
  }

  void make_room(const std::vector<Piece>& pieces) {
    for (KnotIndex k = 0; k < mesh_.knot_slots(); ++k) {
      if (!mesh_.is_knot(k) || mesh_.knot(k).kind != KnotKind::kFree) continue;
      const bool near = std::any_of(pieces.begin(), pieces.end(), [&](const Piece& p) {
        return distance(mesh_.position(k), p) < options_.knot_distance;
      });
      if (near) mesh_.remove(k);
    }
  }

  /// Nothing if only edges that must stay are there.
  std::optional<KnotIndex> insert_knot(Vec2 p) {
    for (FaceIndex f = 0; f < mesh_.face_slots(); ++f) {
      if (!mesh_.is_face(f)) continue;
      const std::array<Vec2, 3> v = mesh_.triangle(f);
      std::size_t nearest = 0;
      std::array<double, 3> height{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec2 a = v[(i + 1) % 3];
        const Vec2 b = v[(i + 2) % 3];
        height[i] = 2 * signed_area(a, b, p) / norm(b - a);
        if (height[i] < height[nearest]) nearest = i;
      }
      if (height[nearest] < -1e-9) continue;
      if (height[nearest] > kOnEdge) return mesh_.insert_in_face(f, p);
      const EditableMesh::Edge e{f, static_cast<int>(nearest)};
      const Vec2 a = v[(nearest + 1) % 3];
      const Vec2 along = v[(nearest + 2) % 3] - a;
      const double t = dot(p - a, along) / dot(along, along);
      const double margin = kOnEdge / norm(along);
      if (mesh_.is_fixed(e) || t < margin || t > 1 - margin) return std::nullopt;
      return mesh_.insert_on_edge(e, a + t * along);
    }
    return std::nullopt;
  }

  /// Flips edges between two knots until these are neighbours.
  bool join(KnotIndex a, KnotIndex b) {
    std::vector<EditableMesh::Edge> crossing;
    if (!find_crossing(a, b, crossing)) return false;
    std::size_t skip = 0;  // those found too bent, or whose flip would not help, go to the end of the row
    for (std::size_t flips = kFlipsPerCrossing * (crossing.size() + 1); !crossing.empty(); --flips) {
      if (flips == 0) return false;
      const EditableMesh::Edge e = crossing[skip % crossing.size()];
      if (!mesh_.can_flip(e)) {
        ++skip;
        continue;
      }
      const std::size_t count = crossing.size();
      mesh_.flip(e);
      if (!find_crossing(a, b, crossing)) return false;
      if (crossing.size() == count) ++skip;
    }
    return true;
  }

  /// The edges between a and b, from a on. @return false if a knot or a fixed edge is in the way.
  bool find_crossing(KnotIndex a, KnotIndex b, std::vector<EditableMesh::Edge>& crossing) const {
    crossing.clear();
    const Vec2 from = mesh_.position(a);
    const Vec2 to = mesh_.position(b);
    std::vector<FaceIndex> ring;
    mesh_.faces_around(a, ring);
    for (const FaceIndex f : ring) {
      const Face& v = mesh_.face(f);
      const std::size_t i = v[0] == a ? 0 : v[1] == a ? 1 : 2;
      if (v[(i + 1) % 3] == b || v[(i + 2) % 3] == b) return true;
    }
    for (const FaceIndex f : ring) {
      const Face& v = mesh_.face(f);
      const std::size_t i = v[0] == a ? 0 : v[1] == a ? 1 : 2;
      if (orientation(from, mesh_.position(v[(i + 1) % 3]), to) <= 0 ||
          orientation(from, mesh_.position(v[(i + 2) % 3]), to) >= 0)
        continue;
      return walk({f, static_cast<int>(i)}, b, from, to, crossing);
    }
    return false;
  }

  bool walk(EditableMesh::Edge e, KnotIndex b, Vec2 from, Vec2 to,
            std::vector<EditableMesh::Edge>& crossing) const {
    for (;;) {
      if (mesh_.is_fixed(e)) return false;
      crossing.push_back(e);
      const EditableMesh::Edge m = mesh_.mirror(e);
      const auto side = static_cast<std::size_t>(m.side);
      const KnotIndex next = mesh_.face(m.face)[side];
      if (next == b) return true;
      const int turn = orientation(from, to, mesh_.position(next));
      if (turn == 0) return false;
      // Seen from the face behind, the edge's first end lies to the left of the way, the second to the right.
      e = {m.face, static_cast<int>(turn > 0 ? (side + 1) % 3 : (side + 2) % 3)};
    }
  }

  std::vector<KnotIndex> with_simple_knots(const std::vector<KnotIndex>& vertices) {
    std::vector<KnotIndex> all{vertices.front()};
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const Vec2 a = mesh_.position(vertices[i - 1]);
      const Vec2 b = mesh_.position(vertices[i]);
      const int inside = knots_inside_segment(norm(b - a), options_.spacing);
      for (int j = 1; j <= inside; ++j) {
        const EditableMesh::Edge e = mesh_.edge_between(all.back(), vertices[i]);
        all.push_back(mesh_.insert_on_edge(e, a + (static_cast<double>(j) / (inside + 1)) * (b - a)));
      }
      all.push_back(vertices[i]);
    }
    for (const KnotIndex k : all) mesh_.legalise_around(k);
    return all;
  }

  EditableMesh& mesh_;
  const InsertOptions& options_;
  std::vector<Piece> taken_;
};

}  // namespace

int knots_inside_segment(double length, double spacing) {
  return std::clamp(static_cast<int>(std::lround(length / spacing)) - 1, 1, 3);
}

std::vector<std::vector<KnotIndex>> insert_polylines(EditableMesh& mesh,
                                                     std::span<const std::vector<Vec2>> lines,
                                                     const InsertOptions& options) {
  Inserter inserter(mesh, options);
  std::vector<std::vector<KnotIndex>> result;
  for (const std::vector<Vec2>& line : lines) result.push_back(inserter.insert(line));
  return result;
}

}  // namespace knotreel::mesh
