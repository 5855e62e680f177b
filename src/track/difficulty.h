// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "knotreel/knots/target.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::track {

/// How hard a picture is: the squared error of the piecewise linear approximation over as many knots as a
/// cold frame may place or wants to, put where the picture asks for them (paper sec. 6.1). Without features,
/// which is much cheaper than a cold frame, and close enough to tell two pictures apart.
/// @param functions control points that the frame may have.
double difficulty(const knots::Target& target, const vectorize::Options& cold, std::size_t functions);

}  // namespace knotreel::track
