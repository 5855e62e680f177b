// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "export/outlines.h"

namespace knotreel::exporting {

/// "#a0b1c2". @param channels  one (grey) or three; clamped.
std::string colour_text(const Rgb& colour, std::size_t channels);

/// Path data of closed outlines, in numbers relative to the point before, to 0.01 px. Outlines without area
/// are left away; "" if all are.
std::string path_data(const std::vector<Loop>& outlines);

/// What all gradients have in common, as an element that they refer to.
std::string gradient_base();

/// A <linearGradient> element for the region's paint.
std::string gradient_text(const std::string& id, const Region& region, std::size_t channels);

}  // namespace knotreel::exporting
