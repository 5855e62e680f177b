// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Spreads the points next to corners and ends of chains that lie within half a pixel of these evenly over
/// the way to the first one farther away. Where several curves meet, the place that fits them all best can be
/// next to a point of one of them, or behind it, and a polyline would turn back for a hundredth of a pixel.
/// Likewise those that are nearer than `least` to any other point of their chain, and corners within half a
/// pixel of another corner, which are none then. Distances are those on the curve or between positions,
/// whatever is less; what the curve is beyond its positions at a sharp corner fades out towards the next
/// points.
/// @param least pixels from a point to the next, more than 0; other corners and ends stay.
void space_points(FeatureChains& chains, double least = 0.25);

}  // namespace knotreel::features
