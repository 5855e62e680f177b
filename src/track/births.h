// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/features/detect.h"
#include "knotreel/image/image.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/spline/basis.h"
#include "knotreel/track/birth_options.h"
#include "track/placed_pixels.h"

namespace knotreel::track {

/// Length of all feature polylines of a mesh, pixels.
double feature_length(const mesh::KnotMesh& mesh);

/// Features of a picture that its model lacks (docs/algorithm.md, "video"): chains are detected anew and
/// matched with the curves of the model, by being near; what is left of them must be stronger than what a
/// curve needs to survive, so that features do not blink, and be missed by the model. Those that it misses
/// most come first.
/// @param basis, displacement the surface of the model. @param seen the picture as it was fitted.
/// @param picture             as it came.
/// @param squared_errors      of the model, per pixel.
/// @param most_length         of all new features together, pixels.
/// @return open polylines in the domain, for mesh::insert_polylines().
std::vector<std::vector<Vec2>> missing_features(const spline::Basis& basis,
                                                std::span<const Vec2> displacement, const PlacedPixels& seen,
                                                const image::Image& picture,
                                                std::span<const float> squared_errors,
                                                const features::DetectOptions& detect, double most_length,
                                                const BirthOptions& options = {});

}  // namespace knotreel::track
