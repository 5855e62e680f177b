// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"
#include "vectorize/mapped_picture.h"
#include "vectorize/run_log.h"
#include "vectorize/samples.h"

namespace knotreel::vectorize {

/// What the rounds of fitting begin with. Parts point into each other.
struct Start {
  MappedPicture mapped;
  std::optional<knots::Target> target;
  std::optional<mesh::EditableMesh> mesh;  ///< with the first knots
  std::optional<Samples> samples;
  std::size_t max_functions = 0;
};

/// Control points that a model may have.
struct Bounds {
  std::size_t usual = 0;
  std::size_t with_features = 0;  ///< where features have no room otherwise; usual or more
};

/// Features within their share of the control points, and the first knots. Where these leave room, all
/// features may stay: a bound on their share keeps them from what the rest of the picture needs. Where some
/// are missed all the same, the bound grows (docs/decisions/0050).
/// @param options in pixels of the grid.
std::unique_ptr<Start> make_start(const Grid& grid, const Options& options, const Bounds& bounds,
                                  RunLog& log);

}  // namespace knotreel::vectorize
