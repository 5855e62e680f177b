// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "param/curves.h"

namespace knotreel::param {

/// Marks the sites that are preferred as vertices, but for those that polylines do well without, and those
/// next to others. Before simplify(), so that polylines of the next picture have the vertices of this one.
void mark_preferred(Curves& curves, const ParametrizeOptions& options);

/// Marks sites as vertices until all segments between marked sites are accepted (modified Douglas-Peucker,
/// paper sec. 5.4). Accepted is a segment along which
/// - the sites are close enough and their projections advance (see ParametrizeOptions),
/// - no other site lies in the pocket between curve and segment, nor does the segment come much closer to one
///   than the curve does.
/// Since curves do not cross, the second condition keeps the polylines apart and on their sides of each
/// other. Marks are only added, so that the function can be called again after sites have moved.
void simplify(Curves& curves, const ParametrizeOptions& options);

/// Finds the last contacts that simplify() leaves, such as two curves between the same nodes that share a
/// chord, and splits the segments concerned, and those that nearly touch, as far as they have sites for that.
/// @return curves dropped because they touch another, or all but touch it, with all their sites as vertices.
int make_planar(Curves& curves, const ParametrizeOptions& options);

/// Splits the segments on which sites lie, each once. @return whether there was any with a site inside.
bool split_segments_of(Curves& curves, const std::vector<SiteIndex>& sites);

}  // namespace knotreel::param
