// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/motion/luma.h"
#include "knotreel/motion/unchanged.h"
#include "knotreel/track/tracker.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

/// Bends the geometry of warm frames to the edges of their pictures: once in a while, if the curves of
/// features miss these by too much (docs/decisions/0020).
class CurveBending {
 public:
  /// @param unfold as vectorize::Options.
  CurveBending(const TrackOptions& options, double unfold) : options_(options), unfold_(unfold) {}

  void start_group();

  /// Changes the displacement of a frame, whose space is there, if it is time to.
  /// @param now the picture. @param rest what stays in it stays as it is. @param has_new_features ones that
  /// were never bent: all are looked at now.
  /// @return whether it was changed.
  bool bend(const motion::Luma& now, const motion::Rest& rest, bool has_new_features, FittedFrame& frame);

  /// The frame is worse than the one before. Curves that were left alone may be why: they are looked at in
  /// all frames for a while.
  void fit_has_fallen();

 private:
  TrackOptions options_;
  double unfold_;
  int since_bend_ = 0;      ///< frames
  int frames_to_bend_ = 0;  ///< in which curves are looked at whatever the interval
};

}  // namespace knotreel::track
