// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/new_knots.h"

#include <algorithm>

#include "knotreel/knots/optimise.h"
#include "knotreel/knots/refine.h"

namespace knotreel::track {

void optimise_new_knots(mesh::EditableMesh& mesh, const std::vector<mesh::KnotIndex>& fresh,
                        const knots::Target& target, const vectorize::Options& cold,
                        const TrackOptions& options) {
  if (fresh.empty() || options.inserted_steps == 0) return;
  knots::OptimiseOptions local = cold.optimise;
  local.rounds = 1;
  local.steps = std::min(local.steps, options.inserted_steps);
  const double share = static_cast<double>(fresh.size()) / static_cast<double>(mesh.knot_count());
  knots::optimise(mesh, target, local, knots::rings_around(mesh, fresh, share > options.much_new ? 1 : 0));
}

}  // namespace knotreel::track
