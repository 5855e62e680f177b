// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/long_edges.h"

#include <algorithm>
#include <array>
#include <queue>
#include <vector>

#include "knotreel/knots/place.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;

constexpr double kDistance = 1.0 / 16;  // of a new knot from what is there, in longest edges

struct LongEdge {
  double length = 0;
  FaceIndex face = 0;
  std::array<KnotIndex, 3> knots{};  ///< of the face when this was found
  Vec2 middle;

  bool operator<(const LongEdge& other) const {
    return length != other.length ? length < other.length : face > other.face;
  }
};

LongEdge longest_edge(const EditableMesh& mesh, FaceIndex f) {
  const auto v = mesh.triangle(f);
  LongEdge longest;
  longest.face = f;
  longest.knots = mesh.face(f);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 a = v[i];
    const Vec2 b = v[(i + 1) % 3];
    if (norm(b - a) > longest.length) {
      longest.length = norm(b - a);
      longest.middle = 0.5 * (a + b);
    }
  }
  return longest;
}

}  // namespace

std::size_t split_long_edges(EditableMesh& mesh, double longest, std::size_t most) {
  std::priority_queue<LongEdge> queue;
  const auto look_at = [&](FaceIndex f) {
    const LongEdge edge = longest_edge(mesh, f);
    if (edge.length > longest) queue.push(edge);
  };
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (mesh.is_face(f)) look_at(f);
  }
  std::size_t inserted = 0;
  std::vector<FaceIndex> ring;
  while (inserted < most && !queue.empty()) {
    const LongEdge edge = queue.top();
    queue.pop();
    if (!mesh.is_face(edge.face) || mesh.face(edge.face) != edge.knots) continue;
    const auto k = insert_near(mesh, edge.face, edge.middle, kDistance * longest);
    if (!k) continue;
    ++inserted;
    mesh.legalise_around(*k);
    mesh.faces_around(*k, ring);
    for (const FaceIndex f : ring) look_at(f);
  }
  return inserted;
}

bool keeps_edges_short(const EditableMesh& mesh, KnotIndex knot, double longest) {
  std::vector<FaceIndex> ring;
  mesh.faces_around(knot, ring);
  std::vector<Vec2> around;
  for (const FaceIndex f : ring) {
    for (const KnotIndex k : mesh.face(f)) {
      if (k != knot) around.push_back(mesh.knot(k).position);
    }
  }
  return std::any_of(around.begin(), around.end(), [&](Vec2 a) {
    return std::any_of(around.begin(), around.end(), [&](Vec2 b) { return norm(b - a) > longest; });
  });
}

}  // namespace knotreel::knots
