// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/fit/colour_fit.h"
#include "knotreel/image/image.h"

namespace knotreel::fit {

struct UniformFitOptions {
  std::size_t control_points = 0;  ///< about how many to aim at; 0: 2 % of the pixels
  int degree = 2;                  ///< of the splines: 1, 2 or 3
  std::uint64_t seed = 1;          ///< of the jitter that keeps knots off common lines
  ColourFitOptions colour{};
};

/// A model of a picture on evenly spread knots without features, with the geometry of the identity and
/// colours fitted by least squares.
/// @throws Error{kInvalidArgument} for an empty picture or a degree out of range.
document::FrameModel fit_uniform(const image::Image& image, const UniformFitOptions& options = {});

/// The knots of fit_uniform: a hexagonal lattice, jittered by a tenth of its spacing, with knots along the
/// sides.
mesh::KnotMesh uniform_mesh(double width, double height, double spacing, std::uint64_t seed);

}  // namespace knotreel::fit
