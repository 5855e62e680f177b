#include "knotreel/track/group_rule.h"

namespace knotreel::track {

Start GroupRule::start_of(const Motion* motion) const {
  if (length_ == 0) return Start::kFirst;
  if (!options_.warm_start) return Start::kInterval;
  if (!motion || motion::is_cut(motion->change, {.threshold = options_.scene_threshold})) return Start::kCut;
  return length_ >= options_.keyframe_interval ? Start::kInterval : Start::kWarm;
}

Start GroupRule::next(const Motion* motion) {
  const Start start = start_of(motion);
  length_ = start == Start::kWarm ? length_ + 1 : 1;
  return start;
}

}  // namespace knotreel::track
