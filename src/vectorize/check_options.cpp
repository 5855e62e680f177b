// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/check_options.h"

#include "knotreel/base/error.h"
#include "knotreel/document/limits.h"
#include "knotreel/spline/space.h"

namespace knotreel::vectorize {

void check_options(const Options& options) {
  const auto refuse = [](const char* what) { throw Error(ErrorKind::kInvalidArgument, what); };
  if (options.degree < 1 || options.degree > spline::kMaxDegree) refuse("the degree must be 1, 2 or 3");
  if (options.rounds < 1) refuse("at least one round is needed");
  if (!(options.mec >= 0) || !(options.block_error >= 0) || !(options.meg >= 0))
    refuse("error bounds cannot be negative");
  if (!(options.feature_share >= 0 && options.feature_share <= 1))
    refuse("the share of features must be 0 to 1");
  const auto is_share = [](double share) { return share >= 0 && share <= 1; };
  if (!is_share(options.weak_share) || !is_share(options.drawn_weak_share))
    refuse("the share of weak features must be 0 to 1");
  if (!(options.corners.most_error > 0)) refuse("the error of a corner must be above zero");
  if (!(options.corners.least_turn >= 0 && options.corners.least_turn <= 180))
    refuse("the least turn of a corner must be 0 to 180 degrees");
  if (!(options.max_turning >= 0)) refuse("the turning of features cannot be negative");
  if (!(options.first_share > 0 && options.first_share <= 1))
    refuse("the share of the first round must be above 0, up to 1");
  if (!(options.unfold > 0 && options.unfold < 1)) refuse("what undoes folds must shrink");
  if (!(options.drawn_blur >= 0)) refuse("the blur of drawn edges cannot be negative");
  if (!(options.noisy_smoothing >= 0)) refuse("the smoothing of noisy drawings cannot be negative");
  if (!(options.drawn_threshold >= 0)) refuse("the threshold of drawn edges cannot be negative");
  if (!(options.drawn_distance > 0)) refuse("the distance of drawn curves must be above zero");
  if (!(options.longest_edge >= 0)) refuse("the longest edge cannot be negative");
  if (!(options.segment_knot_spacing > 0)) refuse("knots of feature segments must be some way apart");
  if (options.descent_steps < 0) refuse("the steps of the descent cannot be negative");
  if (options.optimise.rounds < 0 || options.optimise.steps < 0)
    refuse("the rounds and steps of optimised knots cannot be negative");
  if (!(options.colour.ridge > 0) || !(options.geometry.ridge > 0))
    refuse("the ridge of a fit must be above zero");
  if (!(options.mixed_weight >= 0)) refuse("the weight of mixed pixels cannot be negative");
  if (!(options.colour.step >= 0)) refuse("the step of colours cannot be negative");
  if (options.knot_bits < document::kMinKnotBits || options.knot_bits > document::kMaxKnotBits)
    refuse("the knot bits of a document are 0 to 14");
  if (!(options.displacement_step >= 1.0 / 4096 && options.displacement_step <= 15))
    refuse("the displacement step of a document is 1/4096 to 15 pixels");
}

}  // namespace knotreel::vectorize
