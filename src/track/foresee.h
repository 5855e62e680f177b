// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::track {

/// Errors of the best linear approximation of a picture over the faces of a mesh, by the ids of their knots.
class FaceErrors {
 public:
  FaceErrors(const mesh::KnotMesh& mesh, const knots::Target& target);

  double sum() const { return sum_; }
  /// 0 if there is no such face.
  double of(std::array<std::uint32_t, 3> ids) const;

 private:
  struct Face {
    std::array<std::uint32_t, 3> ids;  ///< ascending
    double error;
  };
  std::vector<Face> faces_;  ///< by ids
  double sum_ = 0;
};

/// What a new picture has that the one before had not, before anything is fitted: the faces whose best linear
/// approximation has become worse.
class Foresight {
 public:
  /// @param mesh of the new picture. @param before of the mesh of the last frame, on its own picture. Faces
  /// that the rework in between has made count as new.
  Foresight(const mesh::EditableMesh& mesh, const knots::Target& target, const FaceErrors& before);

  /// How much worse all faces together have become, dB.
  double loss() const;

  /// By how much each of them has, most first.
  std::vector<double> growths() const;

  /// Puts knots into those that have become worse most, one each, unless they are gone.
  /// @param mesh as at first, but for knots that were taken away. @param count most knots to insert.
  /// @return the new knots.
  std::vector<mesh::KnotIndex> insert(mesh::EditableMesh& mesh, std::size_t count, double min_distance) const;

 private:
  struct Growth {
    double error;
    mesh::FaceIndex face;
    mesh::Face knots;
  };
  std::vector<Growth> growths_;
  double error_before_ = 0;
  double error_now_ = 0;
};

}  // namespace knotreel::track
