// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "knotreel/base/error.h"
#include "knotreel/motion/flow.h"

namespace knotreel::motion {

/// Whether there are as many values as the size tells.
inline bool is_filled(const Luma& luma) {
  return luma.v.size() == std::size_t(luma.width) * std::size_t(luma.height);
}
inline bool is_filled(const Flow& flow) {
  return flow.xy.size() == 2 * std::size_t(flow.width) * std::size_t(flow.height);
}
inline bool is_filled(const image::Image& picture) {
  image::check_image(picture);
  return true;
}

/// @throws Error{kInvalidArgument} if the sizes differ or are empty, or if values are missing.
template <typename A, typename B>
void check_sizes(const A& a, const B& b) {
  if (a.width != b.width || a.height != b.height) {
    throw Error(ErrorKind::kInvalidArgument, "pictures or flows differ in size: " + std::to_string(a.width) +
                                                 "x" + std::to_string(a.height) + " and " +
                                                 std::to_string(b.width) + "x" + std::to_string(b.height));
  }
  if (a.width < 1 || a.height < 1) throw Error(ErrorKind::kInvalidArgument, "a picture or flow is empty");
  if (!is_filled(a) || !is_filled(b))
    throw Error(ErrorKind::kInvalidArgument, "the size of a picture or flow and its values do not agree");
}

}  // namespace knotreel::motion
