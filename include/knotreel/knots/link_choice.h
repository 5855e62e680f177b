// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/knots/target.h"
#include "knotreel/spline/space.h"

namespace knotreel::knots {

/// Chooses link triangulations by the picture (docs/algorithm.md, "links"): of all triangulations of a link
/// polygon of at most `most_corners` corners, the one with the least error of piecewise linear approximation,
/// by dynamic programming; larger polygons get the standard triangulation. Deterministic, may be called from
/// several threads. The target must outlive the policy.
spline::LinkPolicy picture_links(const Target& target, std::size_t most_corners = 14);

}  // namespace knotreel::knots
