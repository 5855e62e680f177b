// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/motion/cut.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/luma.h"
#include "knotreel/motion/unchanged.h"

namespace knotreel::track {

/// What is known of the way from one picture of a video to the next, without any model of them.
struct Motion {
  std::shared_ptr<const motion::Luma> before;
  std::shared_ptr<const motion::Luma> now;
  std::shared_ptr<const motion::Luma> moved;  ///< this picture seen from the place of the one before
  motion::FlowPair flow;                      ///< from the picture before to this one, and back
  std::vector<std::uint8_t> unchanged;        ///< as motion::unchanged_cells()
  double unlikeness = 0;                      ///< as motion::unlikeness()
  bool repeated = false;  ///< the pictures are equal, bit for bit; the rest may be left empty
};

/// @throws Error{kInvalidArgument} if sizes differ.
Motion motion_between(const image::Image& before, const image::Image& now,
                      const motion::FlowOptions& options = {});

}  // namespace knotreel::track
