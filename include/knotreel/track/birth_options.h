// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::track {

/// Which features are added to a model that lacks them.
struct BirthOptions {
  double strength = 1.5;  ///< thresholds of the detection, relative to those of a frame without one before
  double contrast = 60;   ///< least mean range of a channel next to the curve, levels
  double error = 1;       ///< least mean squared error next to the curve, relative to that of the picture
  double reach = 4;       ///< curves nearer to one there is already are taken for it, pixels
  int apart = 5;          ///< curves with another one so near, as those of thin lines, are left alone, pixels
  double min_length = 24;           ///< of what is left of a curve, pixels
  double polyline_distance = 0.75;  ///< of curves from their polylines, pixels
};

}  // namespace knotreel::track
