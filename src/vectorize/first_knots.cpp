// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/first_knots.h"

#include <algorithm>
#include <limits>

#include "knotreel/knots/block_errors.h"
#include "knotreel/knots/long_edges.h"
#include "vectorize/feature_budget.h"

namespace knotreel::vectorize {
namespace {

// Piecewise linear functions need more knots for the same error than the splines over the same knots.
constexpr double kLinearSlack = 1.3;

// Of the knots that the bound leaves, most that go where edges are long.
constexpr double kShareOfLong = 0.25;

}  // namespace

knots::PlaceOptions first_knots(const mesh::EditableMesh& mesh, double functions, const Options& options) {
  const double per_knot = options.degree == 1 ? 1.0 : options.degree == 2 ? 2.56 : 4.1;
  const double more = std::max(0.0, (functions - expected_functions(mesh, options.degree)) / per_knot);
  const double mec = options.mec * kLinearSlack;
  const double block = mec * options.block_error;
  return {.max_knots = mesh.knot_count() + static_cast<std::size_t>(more),
          .mec = mec,
          .face_error = block > 0 ? knots::kBlockSide * knots::kBlockSide * block * block
                                  : std::numeric_limits<double>::infinity(),
          .min_distance = options.optimise.min_distance};
}

void insert_first_knots(const knots::Target& target, std::size_t max_functions, const Options& options,
                        mesh::EditableMesh& mesh) {
  const double share = options.rounds > 1 ? options.first_share : 1.0;
  const knots::PlaceOptions first = first_knots(mesh, share * static_cast<double>(max_functions), options);
  if (options.longest_edge > 0 && !mesh.segments().empty()) {
    const auto room = static_cast<double>(first.max_knots - mesh.knot_count());
    knots::split_long_edges(mesh, options.longest_edge, static_cast<std::size_t>(kShareOfLong * room));
  }
  knots::insert_knots(mesh, target, first);
}

}  // namespace knotreel::vectorize
