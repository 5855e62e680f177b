// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "param/curves.h"

namespace knotreel::param {

/// Moves faired positions back towards pixel centres until no two steps of curves cross or touch. Chains of
/// pixel centres never do; a curve that still does is dropped.
/// @return curves dropped.
int uncross(Curves& curves);

/// Takes a curve out: its pixels are ordinary pixels again.
void drop(Curves& curves, std::uint32_t curve);

}  // namespace knotreel::param
