// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/group_rule.h"

#include "knotreel/base/error.h"
#include "knotreel/document/limits.h"

namespace knotreel::track {

GroupRule::GroupRule(const TrackOptions& options, Start first) : options_(options), first_(first) {
  if (options.keyframe_interval < 1)
    throw Error(ErrorKind::kInvalidArgument, "a group has at least one frame");
  if (options.look_interval < 1)
    throw Error(ErrorKind::kInvalidArgument, "the frames between looks at what drifts are at least 1");
  if (options.rework_interval < 1)
    throw Error(ErrorKind::kInvalidArgument, "knots are looked at every frame or less often");
  if (!(options.temporal_weight >= 0 && options.temporal_weight <= 1))
    throw Error(ErrorKind::kInvalidArgument, "the temporal weight is a share from 0 to 1");
  if (!(options.scene_threshold >= 0))
    throw Error(ErrorKind::kInvalidArgument, "the threshold of cuts is negative");
  if (!(options.repair_patience >= 0))
    throw Error(ErrorKind::kInvalidArgument, "the patience with repairs is negative");
  if (options.bend_interval < 1)
    throw Error(ErrorKind::kInvalidArgument, "feature curves are looked at every frame or less often");
  if (options.knot_bits < document::kMinKnotBits || options.knot_bits > document::kMaxKnotBits)
    throw Error(ErrorKind::kInvalidArgument, "the knot bits of a document are 0 to 14");
  if (!(options.displacement_step > 0))
    throw Error(ErrorKind::kInvalidArgument, "the displacement step of a document is more than 0");
  if (!(options.colour_step > 0 && options.delta_coarseness > 0))
    throw Error(ErrorKind::kInvalidArgument, "the colour steps of a document are more than 0");
}

Start GroupRule::start_of(const Motion* motion) const {
  if (length_ == 0) return first_;
  if (!options_.warm_start) return Start::kInterval;
  if (!motion || motion::is_cut(motion->unlikeness, {.threshold = options_.scene_threshold}))
    return Start::kCut;
  return length_ >= options_.keyframe_interval ? Start::kInterval : Start::kWarm;
}

Start GroupRule::next(const Motion* motion) {
  const Start start = start_of(motion);
  length_ = start == Start::kWarm ? length_ + 1 : 1;
  return start;
}

}  // namespace knotreel::track
