// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "features/gradient.h"
#include "features/link_map.h"
#include "knotreel/features/detect.h"

namespace knotreel::features {

/// Edge drawing: anchors, and walks from anchor to anchor along ridges of the gradient (paper sec. 5.1). Ends
/// are joined to what is near. All links of the map are sound afterwards, except that there may be short
/// chains.
LinkMap draw_edges(const GradientField& field, const DetectOptions& options);

}  // namespace knotreel::features
