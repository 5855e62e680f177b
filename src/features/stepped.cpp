// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/stepped.h"

#include <cstddef>

#include "knotreel/image/two_colours.h"

namespace knotreel::features {
namespace {

constexpr double kShare = 0.9;  // of the points

}  // namespace

bool is_stepped(const image::Image& image, const Chain& chain, int scale) {
  std::size_t looked_at = 0;
  std::size_t stepped = 0;
  for (const ChainPoint& p : chain.points) {
    const int x = p.x / scale;
    const int y = p.y / scale;
    if (x < 1 || y < 1 || x > image.width - 2 || y > image.height - 2) continue;
    ++looked_at;
    stepped += image::has_two_colours(image, x - 1, y - 1) ? 1 : 0;
  }
  return looked_at > 0 && double(stepped) >= kShare * double(looked_at);
}

}  // namespace knotreel::features
