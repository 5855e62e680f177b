// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "export/fit_curve.h"
#include "export/regions.h"

namespace knotreel::exporting {

struct OutlineOptions {
  double tolerance = 0.05;  ///< for joining curves, pixels of the picture
  /// Where the paints on both sides differ by e, outlines may be off by half of this over e, up to half a
  /// pixel: levels times pixels, as `hidden` of RegionOptions.
  double hidden = 0;
  std::size_t channels = 3;
};

/// The outlines of all regions, holes among them, to be filled by the nonzero rule. What two regions share is
/// the same curve in both, reversed.
std::vector<std::vector<Loop>> outlines(const Tessellator& tessellator, const Triangulation& triangles,
                                        const Partition& partition, const OutlineOptions& options);

}  // namespace knotreel::exporting
