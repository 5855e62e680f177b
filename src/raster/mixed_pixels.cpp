// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/raster/mixed_pixels.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/spline/pixel_tiles.h"
#include "raster/feature_trace.h"
#include "raster/sample_pattern.h"
#include "raster/surface.h"
#include "raster/tile.h"

namespace knotreel::raster {
namespace {

constexpr std::size_t kPlacesOfUnsplit = 16;
// Of the tiles in which pictures are drawn at the size of the model: where a geometry folds, the places that
// points have hang on them.
constexpr int kSide = spline::PixelTiles::kSide;

std::size_t place_count(const CrossedPixel& pixel) {
  return pixel.parts ? pixel.parts->size() : kPlacesOfUnsplit;
}

/// Fills in the places of a pixel, and their shares.
void find_places(const CrossedPixel& pixel, Tile& tile, Vec2* places, double* shares) {
  static const auto pattern = sample_pattern<kPlacesOfUnsplit>();
  const Vec2 corner{static_cast<double>(pixel.x), static_cast<double>(pixel.y)};
  std::array<double, kPlacesOfUnsplit> x;
  std::array<double, kPlacesOfUnsplit> y;
  const std::size_t count = place_count(pixel);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = pixel.parts ? (*pixel.parts)[i].centre : corner + pattern[i];
    x[i] = p.x;
    y[i] = p.y;
    shares[i] = pixel.parts ? (*pixel.parts)[i].share : 1.0 / kPlacesOfUnsplit;
  }
  tile.places(x.data(), y.data(), static_cast<int>(count), places);
}

std::size_t tile_number(const CrossedPixel& p, int width) {
  const int columns = (width + kSide - 1) / kSide;
  return static_cast<std::size_t>(p.y / kSide) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(p.x / kSide);
}

/// The numbers of crossed pixels, tile by tile.
std::vector<std::vector<std::size_t>> by_tile(std::span<const CrossedPixel> crossed, int width) {
  const auto tile_of = [width](const CrossedPixel& p) { return tile_number(p, width); };
  std::vector<std::size_t> order(crossed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tile_of(crossed[a]) < tile_of(crossed[b]); });
  std::vector<std::vector<std::size_t>> tiles;
  for (const std::size_t i : order) {
    if (tiles.empty() || tile_of(crossed[tiles.back().front()]) != tile_of(crossed[i])) tiles.emplace_back();
    tiles.back().push_back(i);
  }
  return tiles;
}

}  // namespace

fit::MixedPixels mixed_pixels(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis,
                              std::span<const std::uint8_t> tiles) {
  const Surface surface(model, std::move(basis));
  const auto width = static_cast<int>(surface.width());
  const auto height = static_cast<int>(surface.height());
  std::vector<CrossedPixel> crossed =
      FeatureTrace(surface, model.space->mesh(), tiles).crossed_pixels(1, 1, 0, height, 0, width);
  if (!tiles.empty())
    std::erase_if(crossed, [&](const CrossedPixel& p) { return tiles[tile_number(p, width)] == 0; });
  fit::MixedPixels mixed;
  mixed.begin.push_back(0);
  for (const CrossedPixel& p : crossed) {
    mixed.pixels.push_back(static_cast<std::uint32_t>(p.y) * static_cast<std::uint32_t>(width) +
                           static_cast<std::uint32_t>(p.x));
    mixed.begin.push_back(mixed.begin.back() + place_count(p));
  }
  mixed.places.resize(mixed.begin.back());
  mixed.shares.resize(mixed.begin.back());
  const std::vector<std::vector<std::size_t>> numbers = by_tile(crossed, width);
  parallel_for(numbers.size(), [&](std::size_t t) {
    const CrossedPixel& first = crossed[numbers[t].front()];
    const Vec2 low{static_cast<double>(first.x / kSide * kSide),
                   static_cast<double>(first.y / kSide * kSide)};
    const Vec2 high = low + Vec2{kSide, kSide};
    Tile tile(surface);
    tile.set_block(low, high);
    tile.set(low, high);
    for (const std::size_t i : numbers[t])
      find_places(crossed[i], tile, &mixed.places[mixed.begin[i]], &mixed.shares[mixed.begin[i]]);
  });
  return mixed;
}

}  // namespace knotreel::raster
