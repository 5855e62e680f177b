// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/editable_mesh.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <span>

#include "knotreel/base/error.h"
#include "knotreel/mesh/predicates.h"
#include "mesh/half_edges.h"

namespace knotreel::mesh {

namespace {

// Faces that flips make have at least this area, in squared pixels: three knots of one segment, which are on
// a line but for rounding, must not become a face.
constexpr double kLeastArea = 1e-4;

// And this height, in pixels: flatter ones may be turned over where knots are rounded to the finest grid of
// documents, 2^-14 pixels, twice as coarse on a picture enlarged twofold.
constexpr double kLeastHeight = 2.5e-4;

bool is_flat(Vec2 a, Vec2 b, Vec2 c) {
  const double area = signed_area(a, b, c);
  return area <= kLeastArea || 2 * area <= kLeastHeight * std::max({norm(b - a), norm(c - b), norm(a - c)});
}

constexpr std::size_t next(std::size_t i) {
  return i == 2 ? 0 : i + 1;
}
constexpr std::size_t previous(std::size_t i) {
  return i == 0 ? 2 : i - 1;
}

}  // namespace

EditableMesh::EditableMesh(const KnotMesh& mesh, std::uint32_t first_new_id)
    : width_(mesh.width),
      height_(mesh.height),
      knots_(mesh.knots),
      face_of_(mesh.knots.size(), kNoFace),
      faces_(mesh.faces),
      segments_(mesh.segments),
      next_id_(first_new_id) {
  const auto half_edges = connect_half_edges(mesh.faces);
  if (!half_edges) throw Error(ErrorKind::kInvalidArgument, "cannot edit a knot mesh that is no surface");
  std::map<std::pair<KnotIndex, KnotIndex>, std::uint32_t> segment_of;
  for (std::uint32_t s = 0; s < segments_.size(); ++s) {
    const auto& knots = segments_[s].knots;
    for (std::size_t i = 1; i < knots.size(); ++i) {
      segment_of[std::minmax(knots[i - 1], knots[i])] = s;
    }
  }
  neighbours_.resize(faces_.size());
  segments_of_.resize(faces_.size());
  for (FaceIndex f = 0; f < faces_.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      face_of_[faces_[f][i]] = f;
      const std::uint32_t opposite = half_edges->opposite[3 * f + next(i)];
      neighbours_[f][i] = opposite == kNoHalfEdge ? kNoFace : opposite / 3;
      const auto it = segment_of.find(std::minmax(faces_[f][next(i)], faces_[f][previous(i)]));
      segments_of_[f][i] = it == segment_of.end() ? kNoSegment : it->second;
    }
  }
  for (const Knot& k : knots_) next_id_ = std::max(next_id_, static_cast<std::uint32_t>(k.id) + 1);
}

KnotMesh EditableMesh::to_mesh() const {
  KnotMesh mesh;
  mesh.width = width_;
  mesh.height = height_;
  std::vector<KnotIndex> place(knots_.size(), kNoKnot);
  for (KnotIndex k = 0; k < knots_.size(); ++k) {
    if (!is_knot(k)) continue;
    place[k] = static_cast<KnotIndex>(mesh.knots.size());
    mesh.knots.push_back(knots_[k]);
  }
  for (FaceIndex f = 0; f < faces_.size(); ++f) {
    if (!is_face(f)) continue;
    Face face{place[faces_[f][0]], place[faces_[f][1]], place[faces_[f][2]]};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    mesh.faces.push_back(face);
  }
  std::sort(mesh.faces.begin(), mesh.faces.end());
  mesh.segments = segments_;
  for (FeatureSegment& s : mesh.segments) {
    for (KnotIndex& k : s.knots) k = place[k];
  }
  return mesh;
}

EditableMesh::Edge EditableMesh::mirror(Edge e) const {
  const FaceIndex other = neighbour(e.face, e.side);
  const auto& n = neighbours_[other];
  // Two faces share one edge only, except where one has two of the other's edges, which a disk of more than
  // two faces with straight edges cannot have.
  return {other, n[0] == e.face ? 0 : n[1] == e.face ? 1 : 2};
}

EditableMesh::Edge EditableMesh::edge_between(KnotIndex a, KnotIndex b) const {
  std::vector<FaceIndex> ring;
  faces_around(a, ring);
  for (const FaceIndex f : ring) {
    const auto i = corner_of(f, a);
    if (faces_[f][next(i)] == b) return {f, static_cast<int>(previous(i))};
    if (faces_[f][previous(i)] == b) return {f, static_cast<int>(next(i))};
  }
  throw Error(ErrorKind::kInvalidArgument, "no edge joins these knots");
}

void EditableMesh::faces_around(KnotIndex k, std::vector<FaceIndex>& out) const {
  out.clear();
  out.reserve(8);  // there are six, and growing to them takes four pieces of memory
  const FaceIndex start = face_of_[k];
  // Back to the border, if there is one, so that the walk covers the whole fan.
  FaceIndex first = start;
  for (;;) {
    const FaceIndex f = neighbours_[first][previous(corner_of(first, k))];
    if (f == kNoFace || f == start) break;
    first = f;
  }
  const bool closed = neighbours_[first][previous(corner_of(first, k))] != kNoFace;
  if (closed) first = start;
  FaceIndex f = first;
  do {
    out.push_back(f);
    f = neighbours_[f][next(corner_of(f, k))];
  } while (f != kNoFace && f != first);
}

void EditableMesh::set_face(FaceIndex f, const Face& v, const std::array<FaceIndex, 3>& n,
                            const std::array<std::uint32_t, 3>& s) {
  faces_[f] = v;
  neighbours_[f] = n;
  segments_of_[f] = s;
  for (const KnotIndex k : v) face_of_[k] = f;
}

void EditableMesh::replace_neighbour(FaceIndex f, FaceIndex from, FaceIndex to) {
  if (f == kNoFace) return;
  for (FaceIndex& n : neighbours_[f]) {
    if (n == from) {
      n = to;
      return;
    }
  }
}

FaceIndex EditableMesh::new_face() {
  if (!free_faces_.empty()) {
    const FaceIndex f = free_faces_.back();
    free_faces_.pop_back();
    return f;
  }
  faces_.emplace_back();
  neighbours_.emplace_back();
  segments_of_.emplace_back();
  return static_cast<FaceIndex>(faces_.size() - 1);
}

KnotIndex EditableMesh::new_knot(Vec2 position, KnotKind kind) {
  knots_.push_back({position, kind, KnotId{next_id_++}});
  face_of_.push_back(kNoFace);
  return static_cast<KnotIndex>(knots_.size() - 1);
}

KnotIndex EditableMesh::insert_in_face(FaceIndex f, Vec2 position) {
  const KnotIndex k = new_knot(position, KnotKind::kFree);
  const Face v = faces_[f];
  const auto n = neighbours_[f];
  const auto s = segments_of_[f];
  const FaceIndex g = new_face();
  const FaceIndex h = new_face();
  set_face(f, {k, v[1], v[2]}, {n[0], g, h}, {s[0], kNoSegment, kNoSegment});
  set_face(g, {k, v[2], v[0]}, {n[1], h, f}, {s[1], kNoSegment, kNoSegment});
  set_face(h, {k, v[0], v[1]}, {n[2], f, g}, {s[2], kNoSegment, kNoSegment});
  replace_neighbour(n[1], f, g);
  replace_neighbour(n[2], f, h);
  return k;
}

KnotIndex EditableMesh::insert_on_edge(Edge e, Vec2 position) {
  const FaceIndex f = e.face;
  const auto i = static_cast<std::size_t>(e.side);
  const KnotIndex apex = faces_[f][i];
  const KnotIndex a = faces_[f][next(i)];
  const KnotIndex b = faces_[f][previous(i)];
  const std::uint32_t segment = segments_of_[f][i];
  const FaceIndex other = neighbours_[f][i];
  const KnotKind kind = other == kNoFace        ? KnotKind::kBorder
                        : segment != kNoSegment ? KnotKind::kSegment
                                                : KnotKind::kFree;
  if (kind == KnotKind::kBorder) {
    if (knots_[a].position.x == knots_[b].position.x) position.x = knots_[a].position.x;
    if (knots_[a].position.y == knots_[b].position.y) position.y = knots_[a].position.y;
  }
  const Edge across = other == kNoFace ? Edge{kNoFace, 0} : mirror(e);
  const KnotIndex k = new_knot(position, kind);
  if (segment != kNoSegment) {
    auto& knots = segments_[segment].knots;
    for (std::size_t j = 1; j < knots.size(); ++j) {
      if (std::minmax(knots[j - 1], knots[j]) == std::minmax(a, b)) {
        knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(j), k);
        break;
      }
    }
  }
  const FaceIndex g = new_face();
  const auto n = neighbours_[f];
  const auto s = segments_of_[f];
  const std::size_t at_a = next(i);      // side opposite a: the edge (b, apex)
  const std::size_t at_b = previous(i);  // side opposite b: the edge (apex, a)
  set_face(f, {apex, a, k}, {other, g, n[at_b]}, {segment, kNoSegment, s[at_b]});
  set_face(g, {apex, k, b}, {other, n[at_a], f}, {segment, s[at_a], kNoSegment});
  replace_neighbour(n[at_a], f, g);
  if (other == kNoFace) return k;

  const auto j = static_cast<std::size_t>(across.side);
  const KnotIndex far = faces_[other][j];
  const FaceIndex h = new_face();
  const auto on = neighbours_[other];
  const auto os = segments_of_[other];
  // In the other face the edge runs from b to a.
  const std::size_t at_b2 = next(j);
  const std::size_t at_a2 = previous(j);
  set_face(other, {far, b, k}, {g, h, on[at_a2]}, {segment, kNoSegment, os[at_a2]});
  set_face(h, {far, k, a}, {f, on[at_b2], other}, {segment, os[at_b2], kNoSegment});
  replace_neighbour(on[at_b2], other, h);
  neighbours_[f][0] = h;
  neighbours_[g][0] = other;
  return k;
}

bool EditableMesh::can_flip(Edge e) const {
  if (is_fixed(e)) return false;
  const Edge m = mirror(e);
  const auto i = static_cast<std::size_t>(e.side);
  const Vec2 p = position(faces_[e.face][i]);
  const Vec2 a = position(faces_[e.face][next(i)]);
  const Vec2 b = position(faces_[e.face][previous(i)]);
  const Vec2 q = position(faces_[m.face][static_cast<std::size_t>(m.side)]);
  return !is_flat(p, a, q) && !is_flat(p, q, b);
}

EditableMesh::Edge EditableMesh::flip(Edge e) {
  const Edge m = mirror(e);
  const FaceIndex f = e.face;
  const FaceIndex g = m.face;
  const auto i = static_cast<std::size_t>(e.side);
  const auto j = static_cast<std::size_t>(m.side);
  const KnotIndex p = faces_[f][i];
  const KnotIndex a = faces_[f][next(i)];
  const KnotIndex b = faces_[f][previous(i)];
  const KnotIndex q = faces_[g][j];
  const FaceIndex pa = neighbours_[f][previous(i)];
  const FaceIndex bp = neighbours_[f][next(i)];
  const FaceIndex aq = neighbours_[g][next(j)];
  const FaceIndex qb = neighbours_[g][previous(j)];
  const std::uint32_t spa = segments_of_[f][previous(i)];
  const std::uint32_t sbp = segments_of_[f][next(i)];
  const std::uint32_t saq = segments_of_[g][next(j)];
  const std::uint32_t sqb = segments_of_[g][previous(j)];
  set_face(f, {p, a, q}, {aq, g, pa}, {saq, kNoSegment, spa});
  set_face(g, {p, q, b}, {qb, bp, f}, {sqb, sbp, kNoSegment});
  replace_neighbour(aq, g, f);
  replace_neighbour(bp, f, g);
  return {f, 1};
}

void EditableMesh::make_segment(KnotIndex a, KnotIndex b) {
  const Edge e = edge_between(a, b);
  const Edge m = mirror(e);
  const auto segment = static_cast<std::uint32_t>(segments_.size());
  segments_.push_back({{a, b}});
  segments_of_[e.face][static_cast<std::size_t>(e.side)] = segment;
  segments_of_[m.face][static_cast<std::size_t>(m.side)] = segment;
  for (const KnotIndex k : {a, b}) knots_[k].kind = KnotKind::kVertex;
}

void EditableMesh::legalise_around(KnotIndex k) {
  std::vector<FaceIndex> open;
  faces_around(k, open);
  while (!open.empty()) {
    const FaceIndex f = open.back();
    open.pop_back();
    const Edge e{f, static_cast<int>(corner_of(f, k))};
    if (is_fixed(e)) continue;
    const Edge m = mirror(e);
    const auto [a, b, c] = triangle(f);
    if (!in_circle(a, b, c, position(faces_[m.face][static_cast<std::size_t>(m.side)])) || !can_flip(e))
      continue;
    flip(e);
    open.push_back(e.face);
    open.push_back(m.face);
  }
}

std::array<KnotIndex, 2> EditableMesh::line_neighbours(KnotIndex k) const {
  std::array<KnotIndex, 2> ends{kNoKnot, kNoKnot};
  std::size_t found = 0;
  std::vector<FaceIndex> ring;
  faces_around(k, ring);
  const auto add = [&](KnotIndex other) {
    if (found < 2 && (found == 0 || ends[0] != other)) ends[found++] = other;
  };
  for (const FaceIndex f : ring) {
    const auto i = corner_of(f, k);
    if (is_fixed({f, static_cast<int>(previous(i))})) add(faces_[f][next(i)]);
    if (is_fixed({f, static_cast<int>(next(i))})) add(faces_[f][previous(i)]);
  }
  return ends;
}

Vec2 EditableMesh::projected(KnotIndex k, Vec2 target) const {
  const Knot& knot = knots_[k];
  if (knot.kind == KnotKind::kFree) return target;
  if (knot.kind == KnotKind::kVertex) return knot.position;
  if (knot.kind == KnotKind::kBorder) {
    const bool upright = knot.position.x == 0 || knot.position.x == width_;
    return upright ? Vec2{knot.position.x, target.y} : Vec2{target.x, knot.position.y};
  }
  // On the line of the whole segment, so that rounding does not add up over many moves.
  thread_local std::vector<FaceIndex> ring;
  faces_around(k, ring);
  for (const FaceIndex f : ring) {
    const std::uint32_t s = segment(f, static_cast<int>(next(corner_of(f, k))));
    if (s == kNoSegment) continue;
    const Vec2 from = position(segments_[s].knots.front());
    const Vec2 along = position(segments_[s].knots.back()) - from;
    return from + (dot(target - from, along) / dot(along, along)) * along;
  }
  return knot.position;
}

bool EditableMesh::move(KnotIndex k, Vec2 target) {
  if (knots_[k].kind == KnotKind::kVertex) return false;
  const Vec2 old = knots_[k].position;
  const Vec2 goal = projected(k, target);
  if (knots_[k].kind != KnotKind::kFree) {
    const auto [a, b] = line_neighbours(k);
    if (dot(position(a) - goal, position(b) - goal) >= 0) return false;  // beyond a neighbour on the line
  }
  knots_[k].position = goal;
  thread_local std::vector<FaceIndex> ring;
  faces_around(k, ring);
  for (const FaceIndex f : ring) {
    const auto [a, b, c] = triangle(f);
    if (orientation(a, b, c) <= 0) {
      knots_[k].position = old;
      return false;
    }
  }
  return true;
}

void EditableMesh::undo_flips(std::span<const std::array<KnotIndex, 2>> edges) {
  for (auto edge = edges.rbegin(); edge != edges.rend(); ++edge) {
    // Once brings the old edge back, but each face in the place of the other; thrice puts that right, too.
    Edge e = edge_between((*edge)[0], (*edge)[1]);
    for (int i = 0; i < 3; ++i) e = flip(e);
  }
}

bool EditableMesh::remove(KnotIndex k) {
  const bool on_border = knots_[k].kind == KnotKind::kBorder;
  if (knots_[k].kind != KnotKind::kFree && !on_border) return false;
  if (!flip_to_degree(k, on_border ? 2 : 3)) return false;
  std::vector<FaceIndex> ring;
  faces_around(k, ring);
  // The faces around the knot become one. Each has an outer edge, opposite the knot; on the border the third
  // edge is a piece of the side.
  std::array<KnotIndex, 3> v;
  std::array<FaceIndex, 3> n{kNoFace, kNoFace, kNoFace};
  std::array<std::uint32_t, 3> s{kNoSegment, kNoSegment, kNoSegment};
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto at = corner_of(ring[i], k);
    v[i] = faces_[ring[i]][next(at)];
    if (on_border) v[i + 1] = faces_[ring[i]][previous(at)];
    n[previous(i)] = neighbours_[ring[i]][at];
    s[previous(i)] = segments_of_[ring[i]][at];
  }
  // Face i runs from v[i] to v[i+1], so its outer edge is opposite v[i+2].
  set_face(ring[0], v, n, s);
  for (std::size_t i = 1; i < ring.size(); ++i) {
    replace_neighbour(n[previous(i)], ring[i], ring[0]);
    faces_[ring[i]] = {kNoKnot, kNoKnot, kNoKnot};
    free_faces_.push_back(ring[i]);
  }
  face_of_[k] = kNoFace;
  ++removed_knots_;
  return true;
}

bool EditableMesh::flip_to_degree(KnotIndex k, std::size_t faces) {
  std::vector<FaceIndex> ring;
  faces_around(k, ring);
  if (ring.size() < faces) return false;
  std::vector<std::array<KnotIndex, 2>> flipped;  // the edges that flips made
  while (ring.size() > faces) {
    const auto spoke = [&](FaceIndex f) { return Edge{f, static_cast<int>(next(corner_of(f, k)))}; };
    const auto ear = std::find_if(ring.begin(), ring.end(), [&](FaceIndex f) { return can_flip(spoke(f)); });
    if (ear == ring.end()) {
      undo_flips(flipped);
      return false;
    }
    const Edge made = flip(spoke(*ear));
    const auto side = static_cast<std::size_t>(made.side);
    flipped.push_back({faces_[made.face][next(side)], faces_[made.face][previous(side)]});
    faces_around(k, ring);
  }
  return true;
}

}  // namespace knotreel::mesh
