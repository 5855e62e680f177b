// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/curve_bending.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "knotreel/document/stored_mesh.h"
#include "knotreel/fit/geometry_fit.h"
#include "track/bend_geometry.h"
#include "track/edge_points.h"
#include "track/resting_knots.h"

namespace knotreel::track {

namespace {

constexpr int kFramesToBend = 16;

}  // namespace

void CurveBending::start_group() {
  since_bend_ = options_.bend_interval;
  frames_to_bend_ = 0;
}

void CurveBending::fit_has_fallen() {
  if (since_bend_ > 0) frames_to_bend_ = kFramesToBend;
}

bool CurveBending::bend(const motion::Luma& now, const motion::Rest& rest, bool has_new_features,
                        FittedFrame& frame) {
  frames_to_bend_ = std::max(0, frames_to_bend_ - 1);
  const int interval = frames_to_bend_ > 0 ? 1 : options_.bend_interval;
  if (++since_bend_ < interval && !has_new_features) return false;
  since_bend_ = 0;
  const EdgePoints edges = find_edge_points(*frame.basis, frame.displacement, now);
  if (edges.rms <= options_.curve_error && !has_new_features) return false;
  std::vector<std::uint8_t> held;
  if (!has_new_features) held = resting_geometry(*frame.space, resting_knots(frame.space->mesh(), rest));
  bend_geometry(*frame.basis, edges.points, frame.displacement, held);
  document::round_displacement(frame.displacement, options_.displacement_step);
  fit::unfold_geometry(*frame.basis, frame.displacement, unfold_);
  document::round_displacement(frame.displacement, options_.displacement_step);
  return true;
}

}  // namespace knotreel::track
