// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/curve_error.h"

#include "track/edge_points.h"

namespace knotreel::track {

double curve_error(const document::FrameModel& model, const motion::Luma& picture) {
  return curve_error(model, spline::Basis(model.space), picture);
}

double curve_error(const document::FrameModel& model, const spline::Basis& basis,
                   const motion::Luma& picture) {
  if (model.space->mesh().segments.empty()) return 0;
  return mean_edge_distance(basis, model.displacement, picture);
}

}  // namespace knotreel::track
