#pragma once

#include <cstddef>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::track {

/// What a new picture has that the one before had not, before anything is fitted: the faces whose best linear
/// approximation has become worse.
class Foresight {
 public:
  /// @param mesh of the new picture. @param before, target_before the mesh that it comes from, and its
  /// picture.
  Foresight(const mesh::EditableMesh& mesh, const knots::Target& target, const mesh::KnotMesh& before,
            const knots::Target& target_before);

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
