// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/scale.h"

#include "knotreel/base/error.h"

namespace knotreel::features {

int scale_of(const FeatureChains& chains, const image::Image& picture) {
  for (const int scale : {1, 2}) {
    if (chains.width == scale * picture.width && chains.height == scale * picture.height) return scale;
  }
  throw Error(ErrorKind::kInvalidArgument, "picture and feature chains are of different sizes");
}

}  // namespace knotreel::features
