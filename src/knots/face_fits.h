// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::knots {

/// Linear approximations of the faces of a mesh, found when first asked for and kept until they are told to
/// be out of date: to move a knot or to flip an edge leaves most of them as they are.
class FaceFits {
 public:
  FaceFits(const mesh::EditableMesh& mesh, const Target& target)
      : mesh_(mesh), target_(target), fits_(mesh.face_slots()), known_(mesh.face_slots(), 0) {}

  /// Safe to call from several threads for different faces.
  const LinearFit& at(mesh::FaceIndex f) {
    if (!known_[f]) set(f, target_.fit(mesh_.triangle(f)));
    return fits_[f];
  }
  void set(mesh::FaceIndex f, const LinearFit& fit) {
    fits_[f] = fit;
    known_[f] = 1;
  }
  void forget(mesh::FaceIndex f) { known_[f] = 0; }

  /// Finds those of many faces at once; no face may be listed twice.
  void find(const std::vector<mesh::FaceIndex>& faces) {
    constexpr std::size_t kBlock = 64;
    parallel_for((faces.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(faces.size(), (block + 1) * kBlock); ++i)
        at(faces[i]);
    });
  }

 private:
  const mesh::EditableMesh& mesh_;
  const Target& target_;
  std::vector<LinearFit> fits_;
  std::vector<char> known_;
};

}  // namespace knotreel::knots
