// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Marks the points where straight stretches of eight pixels and more end in a bend as ChainPoint::preferred:
/// with a vertex there, a polyline has the stretch for a segment of its own, which is straight, and others
/// for the bend (docs/decisions/0043). Sharp corners are vertices anyhow. Stepped chains say too little, and
/// stay. Linear time. The same bits for any number of threads. Safe to call from several threads on different
/// chains.
void prefer_side_ends(FeatureChains& chains);

}  // namespace knotreel::features
