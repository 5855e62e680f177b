// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/motion.h"

#include "knotreel/motion/warp.h"

namespace knotreel::track {

Motion motion_between(const image::Image& before, const image::Image& now,
                      const motion::FlowOptions& options) {
  Motion motion;
  motion.repeated =
      before.width == now.width && before.channels == now.channels && before.samples == now.samples;
  if (motion.repeated) return motion;
  motion.unchanged = motion::unchanged_cells(before, now);
  motion.before = std::make_shared<const motion::Luma>(motion::luma_of(before));
  motion.now = std::make_shared<const motion::Luma>(motion::luma_of(now));
  motion.flow = motion::find_flow_pair(*motion.before, *motion.now, motion.unchanged, options);
  motion.moved = std::make_shared<const motion::Luma>(motion::warp(*motion.now, motion.flow.forward));
  motion.unlikeness = motion::unlikeness(*motion.before, *motion.moved);
  return motion;
}

}  // namespace knotreel::track
