// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/soften.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/colour_mean.h"

namespace knotreel::raster {
std::vector<Place> next_to(std::span<const CrossedPixel> crossed, const Region& region) {
  std::vector<std::uint8_t> found(region.pixel_count(), 0);
  std::vector<Place> places;
  for (const CrossedPixel& pixel : crossed) {
    for (int y = std::max(pixel.y - kSoftReach, region.row_begin);
         y < std::min(pixel.y + kSoftReach + 1, region.row_end); ++y) {
      for (int x = std::max(pixel.x - kSoftReach, region.column_begin);
           x < std::min(pixel.x + kSoftReach + 1, region.column_end); ++x) {
        std::uint8_t& is_found = found[region.index(x, y)];
        if (!is_found) places.push_back({x, y});
        is_found = 1;
      }
    }
  }
  return places;
}

void soften_edges(std::span<const CrossedPixel> crossed, double softness, const Part& inner,
                  const Part& drawn) {
  const std::vector<Place> places = next_to(crossed, inner);
  const std::array<double, 2 * kSoftReach + 1> filter{softness, 1 - 2 * softness, softness};
  std::vector<float> softened(places.size() * drawn.channels);
  for (std::size_t i = 0; i < places.size(); ++i) {
    ColourMean mean(drawn.channels);
    for (int v = 0; v <= 2 * kSoftReach; ++v) {
      for (int u = 0; u <= 2 * kSoftReach; ++u) {
        const int x = std::clamp(places[i].x + u - kSoftReach, drawn.column_begin, drawn.column_end - 1);
        const int y = std::clamp(places[i].y + v - kSoftReach, drawn.row_begin, drawn.row_end - 1);
        mean.add(drawn.at(x, y), 1,
                 filter[static_cast<std::size_t>(u)] * filter[static_cast<std::size_t>(v)]);
      }
    }
    mean.store(softened.data() + i * drawn.channels);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::copy_n(softened.data() + i * drawn.channels, drawn.channels, drawn.at(places[i].x, places[i].y));
  }
}

}  // namespace knotreel::raster
