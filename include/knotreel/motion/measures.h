// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/motion/flow.h"

namespace knotreel::motion {

/// How much a result flickers that should look like a reference: frames in order, one after the other.
/// Figures are in levels of the scale 0..255; samples are taken as they are, without rounding; alpha counts
/// like the other channels, and these are multiplied by it. Not thread safe; all threads are used, and their
/// number does not show.
class FlickerMeter {
 public:
  /// The next frame.
  /// @param reference, result pictures of one size and as many channels, the same for all frames.
  /// @param flow of the reference, from the frame before to this one; null (and at the first frame) for no
  ///   figure along the flow.
  /// @param consistent pixels of the frame before whose flow counts, as from consistent(); null for all that
  ///   land inside the picture.
  /// @throws Error{kInvalidArgument} if sizes or channels differ; the frame is left out then.
  void add(const image::Image& reference, const image::Image& result, const Flow* flow = nullptr,
           const std::vector<std::uint8_t>* consistent = nullptr);

  /// Mean over frames, pixels and channels of |(R_t - R_t-1) - (I_t - I_t-1)| with result R and reference I:
  /// what changes in the result and not in the reference, at places that stay. 0 before the second frame.
  double flicker() const;

  /// The same at places that move along: of |(R_t(p + f(p)) - R_t-1(p)) - (I_t(p + f(p)) - I_t-1(p))| over
  /// the pixels p whose flow f(p) counts, then over the frames that have such pixels. 0 if there are none.
  double warped_flicker() const;

  /// Per frame from the second on; not a number in `warped` where no pixel counts.
  const std::vector<double>& per_frame() const { return plain_; }
  const std::vector<double>& warped_per_frame() const { return warped_; }

 private:
  image::Image error_before_;  // result minus reference of the frame before
  std::vector<double> plain_;
  std::vector<double> warped_;
};

}  // namespace knotreel::motion
