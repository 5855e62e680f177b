// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

/// Optimisation of a knot mesh for the piecewise linear approximation of a picture (paper sec. 6.2, Eq.
/// 7-10): a cheap stand-in for the TCB-spline surface over the same knots.
namespace knotreel::knots {

/// Sum over all faces of the error of the best linear approximation (paper Eq. 7).
double linear_energy(const mesh::EditableMesh& mesh, const Target& target);

/// Gradient of linear_energy() by the position of a knot (paper Eq. 8), with the linear approximations held:
/// from the errors on both sides of its edges, as if all pixels there had weight 1. Where there are weights
/// it is only a direction.
Vec2 energy_gradient(const mesh::EditableMesh& mesh, const Target& target, mesh::KnotIndex knot);

struct OptimiseOptions {
  int rounds = 4;          ///< of positions, then connectivity
  int steps = 5;           ///< I_max of Eq. 10: sweeps over the positions in each round
  double alpha = 0.4;      ///< of Eq. 10: first step, as a share of the shortest edge at the knot; 0.3 to 0.5
  double least_angle = 5;  ///< degrees; flips make no smaller angle, and slivers below it are removed
  double min_distance = 1.0;  ///< of knots from each other and from features and border, pixels
  bool positions = true;      ///< for ablation
  bool connectivity = true;   ///< for ablation
};

/// The knots but those of kind kVertex in classes without neighbours, greedily, so that the knots of a class
/// can be moved at the same time.
std::vector<std::vector<mesh::KnotIndex>> independent_knots(const mesh::EditableMesh& mesh,
                                                            const std::vector<mesh::KnotIndex>& knots);

/// Flips edges of the given faces, and of those changed on the way, while that lowers the energy
/// (paper 6.2.2).
/// @return the number of flips.
std::size_t optimise_connectivity(mesh::EditableMesh& mesh, const Target& target,
                                  const OptimiseOptions& options, const std::vector<mesh::FaceIndex>& faces);

/// Removes free knots closer than min_distance to a feature or to the border, or with an adjacent angle below
/// least_angle or above 180 - least_angle that no flip mends (paper 6.2.2).
/// @return the number of knots removed.
std::size_t remove_slivers(mesh::EditableMesh& mesh, const Target& target, const OptimiseOptions& options);

/// Alternates descent and flips over the knots for which `active` holds (all, if it is empty).
void optimise(mesh::EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
              const std::vector<bool>& active = {});

}  // namespace knotreel::knots
