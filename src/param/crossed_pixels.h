// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/param/parametrization.h"

namespace knotreel::param {

/// Sets to 0 the weights of pixels whose closed square a feature polyline meets.
void clear_crossed_pixels(const Parametrization& parametrization, std::vector<float>& weights);

}  // namespace knotreel::param
