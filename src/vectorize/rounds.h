// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"
#include "vectorize/draft.h"

namespace knotreel::vectorize {

/// Knots and the surface over them, round by round (paper sec. 6 and 7): the first ones where the picture
/// asks for them, then more where the last fit is worst.
class Rounds {
 public:
  /// All outlive this. @param max_functions control points of the model, at most.
  Rounds(const Options& options, const knots::Target& target, const Samples& samples,
         std::size_t max_functions, RunLog& log, Draft& draft)
      : options_(options),
        target_(target),
        samples_(samples),
        max_functions_(max_functions),
        log_(log),
        draft_(draft) {}

  /// @param mesh with the first knots. @param knots that mesh, with the knots where they have settled.
  void first(mesh::EditableMesh mesh, mesh::KnotMesh& knots);
  /// @param round from 2 on. @param left_out if not empty, the picture as a whole is good enough, and knots
  /// go only where these squared errors of the pixels are. @return whether it changed anything.
  bool next(int round, const std::vector<float>& left_out);

 private:
  void settle_first_knots(mesh::KnotMesh& knots);
  bool refine(int round, const std::vector<float>& left_out);
  std::vector<mesh::KnotIndex> refine_curves();
  void make_space(bool last_round);
  void keep_bound(bool last_round);
  void fit(bool last_round);

  const Options& options_;
  const knots::Target& target_;
  const Samples& samples_;
  std::size_t max_functions_;
  RunLog& log_;
  Draft& draft_;
  std::unique_ptr<mesh::EditableMesh> mesh_;
  bool curves_refined_ = true;  ///< knots were put on curves after the last geometry fit
};

}  // namespace knotreel::vectorize
