// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "param/curves.h"

namespace knotreel::param {

/// Continues the last end of an open curve to the nearest side of the domain: by pixels straight to the
/// outermost ring, then by a site exactly on the side. Nothing is done, and the end stays a tip, where other
/// chains are in the way, the side is more than a few pixels off, or the end is too close to a domain corner.
/// @return whether the curve now ends on a side.
bool continue_to_border(Curves& curves, Curve& curve);

}  // namespace knotreel::param
