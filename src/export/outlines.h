#pragma once

#include <vector>

#include "export/fit_curve.h"
#include "export/regions.h"

namespace knotreel::exporting {

/// The outlines of all regions, holes among them, to be filled by the nonzero rule. What two regions share is
/// the same curve in both, reversed. @param tolerance  for joining curves, pixels of the picture.
std::vector<std::vector<Loop>> outlines(const Tessellator& tessellator, const Triangulation& triangles,
                                        const Partition& partition, double tolerance);

}  // namespace knotreel::exporting
