// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <string>
#include <vector>

#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::testing {

/// Random edits of a mesh, such as the optimisation of knots makes them.
class MeshEdits {
 public:
  MeshEdits(mesh::EditableMesh& mesh, std::uint64_t seed) : mesh_(mesh), random_(seed) {}

  /// One random edit, or an attempt at it. @return what was tried.
  std::string step() {
    switch (count(6)) {
      case 0:
        insert_in_some_face();
        return "insert in face";
      case 1:
        insert_on_some_edge();
        return "insert on edge";
      case 2:
        flip_some_edge();
        return "flip";
      case 3:
        mesh_.remove(some_knot());
        return "remove";
      case 4:
        mesh_.legalise_around(some_knot());
        return "legalise";
      default:
        move_some_knot();
        return "move";
    }
  }

  /// @return the new knot, or kNoKnot if the face that was drawn is too small.
  mesh::KnotIndex insert_in_some_face() {
    const mesh::FaceIndex f = some_face();
    const auto [a, b, c] = mesh_.triangle(f);
    if (signed_area(a, b, c) < 1) return mesh::kNoKnot;
    const double s = uniform(0.1, 0.8);
    const double t = uniform(0.1, 0.9) * (1 - s);
    return mesh_.insert_in_face(f, a + s * (b - a) + t * (c - a));
  }

  mesh::KnotIndex insert_on_some_edge() { return insert_on({some_face(), count(3)}); }

  /// @return the new knot, or kNoKnot if the faces there are too small.
  mesh::KnotIndex insert_on(mesh::EditableMesh::Edge e) {
    const auto t = mesh_.triangle(e.face);
    const mesh::FaceIndex other = mesh_.neighbour(e.face, e.side);
    for (const mesh::FaceIndex f : {e.face, other == mesh::kNoFace ? e.face : other}) {
      const auto [a, b, c] = mesh_.triangle(f);
      if (signed_area(a, b, c) < 1) return mesh::kNoKnot;
    }
    const Vec2 a = t[static_cast<std::size_t>((e.side + 1) % 3)];
    const Vec2 b = t[static_cast<std::size_t>((e.side + 2) % 3)];
    return mesh_.insert_on_edge(e, a + uniform(0.2, 0.8) * (b - a));
  }

  void flip_some_edge() {
    const mesh::EditableMesh::Edge e{some_face(), count(3)};
    if (mesh_.can_flip(e)) mesh_.flip(e);
  }

  void move_some_knot() {
    const mesh::KnotIndex k = some_knot();
    mesh_.move(k, mesh_.position(k) + Vec2{uniform(-10, 10), uniform(-10, 10)});
  }

  mesh::KnotIndex some_knot() {
    for (;;) {
      const auto k = static_cast<mesh::KnotIndex>(count(static_cast<int>(mesh_.knot_slots())));
      if (mesh_.is_knot(k)) return k;
    }
  }

  mesh::FaceIndex some_face() {
    for (;;) {
      const auto f = static_cast<mesh::FaceIndex>(count(static_cast<int>(mesh_.face_slots())));
      if (mesh_.is_face(f)) return f;
    }
  }

  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  int count(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

 private:
  mesh::EditableMesh& mesh_;
  std::mt19937_64 random_;
};

}  // namespace knotreel::testing
