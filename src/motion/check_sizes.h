#pragma once

#include <string>

#include "knotreel/base/error.h"

namespace knotreel::motion {

/// For whatever has a width and a height.
/// @throws Error{kInvalidArgument} if the sizes differ or are empty.
template <typename A, typename B>
void check_sizes(const A& a, const B& b) {
  if (a.width != b.width || a.height != b.height) {
    throw Error(ErrorKind::kInvalidArgument, "pictures or flows differ in size: " + std::to_string(a.width) +
                                                 "x" + std::to_string(a.height) + " and " +
                                                 std::to_string(b.width) + "x" + std::to_string(b.height));
  }
  if (a.width < 1 || a.height < 1) throw Error(ErrorKind::kInvalidArgument, "a picture or flow is empty");
}

}  // namespace knotreel::motion
