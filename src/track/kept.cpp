// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/kept.h"

#include <algorithm>
#include <cstring>

#include "base/tiles_around.h"
#include "knotreel/base/parallel.h"
#include "track/matching.h"

namespace knotreel::track {

namespace {

using fit::PlacesOfTile;
using spline::FunctionIndex;
using spline::PixelTiles;

/// Around tiles whose places are not known, known ones are looked at too: places are up to some pixels away.
constexpr std::size_t kTilesAround = 2;

template <class Visit>
void for_tiles(const PixelTiles& tiles, Visit&& visit) {
  const std::size_t columns = tiles.tile_columns();
  parallel_for(tiles.tile_rows(), [&](std::size_t row) {
    for (std::size_t t = row * columns; t < (row + 1) * columns; ++t) visit(t);
  });
}

/// Whether the numbers of the pixels of a tile are the same, bit for bit. @param size numbers per pixel.
template <class Number>
bool same_numbers(const PixelTiles& tiles, std::size_t index, std::span<const Number> a,
                  std::span<const Number> b, std::size_t size = 1) {
  if (a.size() != b.size()) return false;
  if (a.empty()) return true;
  const PixelTiles::Tile tile = tiles.tile(index);
  const std::size_t count = static_cast<std::size_t>(tile.right - tile.left) * size;
  for (int y = tile.top; y < tile.bottom; ++y) {
    const std::size_t from = (std::size_t(y) * std::size_t(tiles.width()) + std::size_t(tile.left)) * size;
    if (std::memcmp(a.data() + from, b.data() + from, count * sizeof(Number)) != 0) return false;
  }
  return true;
}

bool same_places(const spline::PlacedBasis& a, const spline::PlacedBasis& b, std::size_t tile) {
  const bool centres = a.values().at_centres(tile);
  if (centres || b.values().at_centres(tile)) return centres == b.values().at_centres(tile);
  return same_numbers(a.values(), tile, a.places(), b.places());
}

bool all_of(std::span<const FunctionIndex> functions, const std::vector<std::uint8_t>& flags) {
  return std::all_of(functions.begin(), functions.end(), [&](FunctionIndex f) { return flags[f] != 0; });
}

/// From kUnknown and kAllKnown.
void mark_near_unknown(std::size_t columns, std::vector<PlacesOfTile>& tiles) {
  std::vector<std::uint8_t> unknown(tiles.size());
  for (std::size_t t = 0; t < tiles.size(); ++t) unknown[t] = tiles[t] == PlacesOfTile::kUnknown ? 1 : 0;
  const std::vector<std::uint8_t> near = tiles_around(unknown, columns, kTilesAround);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (near[t] && !unknown[t]) tiles[t] = PlacesOfTile::kKnown;
  }
}

}  // namespace

Kept::Kept(const FittedFrame& before, const FittedFrame& frame, std::span<const std::uint32_t> match)
    : before_(before), frame_(frame), match_(match) {
  if (before.prints.empty() || frame.prints.empty()) return;
  functions_.resize(match.size());
  for (FunctionIndex f = 0; f < match.size(); ++f)
    functions_[f] = match[f] != kNoMatch && before.prints[match[f]] == frame.prints[f] ? 1 : 0;
  if (!before.seen.placed->places().empty()) find_places();
}

void Kept::find_places() {
  const spline::PixelValues& values = before_.values();
  const auto is_kept = [&](FunctionIndex f) {
    return functions_[f] && before_.displacement[before_.space->geometry_of()[match_[f]]] ==
                                frame_.displacement[frame_.space->geometry_of()[f]];
  };
  std::vector<std::uint8_t> kept(before_.prints.size(), 0);  // by function of the frame before
  for (FunctionIndex f = 0; f < functions_.size(); ++f) {
    if (is_kept(f)) kept[match_[f]] = 1;
  }
  places_.resize(values.tile_count());
  for_tiles(values, [&](std::size_t t) {
    places_[t] = all_of(values.functions(t), kept) ? PlacesOfTile::kAllKnown : PlacesOfTile::kUnknown;
  });
  mark_near_unknown(values.tile_columns(), places_);
  std::vector<std::uint8_t> near(kept.size(), 0);
  for (std::size_t t = 0; t < places_.size(); ++t) {
    if (places_[t] == PlacesOfTile::kAllKnown) continue;
    for (const FunctionIndex f : values.functions(t)) near[f] = 1;
  }
  placing_.resize(functions_.size());
  for (FunctionIndex f = 0; f < placing_.size(); ++f) placing_[f] = !is_kept(f) || near[match_[f]] ? 1 : 0;
}

fit::KnownPlaces Kept::places() const {
  if (places_.empty()) return {};
  return {before_.seen.placed->places(), places_, placing_};
}

void Kept::see() {
  if (!is_known()) return;
  const spline::PixelValues& values = frame_.values();
  tiles_.resize(values.tile_count());
  for_tiles(values, [&](std::size_t t) {
    tiles_[t] =
        all_of(values.functions(t), functions_) && same_places(*before_.seen.placed, *frame_.seen.placed, t)
            ? 1
            : 0;
  });
}

std::vector<std::uint8_t> Kept::ages() const {
  std::vector<std::uint8_t> ages(match_.size(), 0);
  if (!is_known()) return ages;
  const spline::PixelValues& values = frame_.values();
  const image::Image& picture = frame_.seen.picture;
  const auto channels = static_cast<std::size_t>(picture.channels);
  std::vector<std::uint8_t> most(tiles_.size());  // by tile
  for_tiles(values, [&](std::size_t t) {
    const bool same_colours =
        same_numbers<float>(values, t, picture.samples, before_.seen.picture.samples, channels) &&
        same_numbers<float>(values, t, frame_.seen.weights, before_.seen.weights);
    most[t] = !same_colours ? 0 : tiles_[t] ? 255 : 1;
  });
  for (FunctionIndex f = 0; f < ages.size(); ++f)
    ages[f] = functions_[f] ? static_cast<std::uint8_t>(std::min(before_.ages[match_[f]] + 1, 255)) : 1;
  for (std::size_t t = 0; t < most.size(); ++t) {
    if (most[t] == 255) continue;
    for (const FunctionIndex f : values.functions(t)) ages[f] = std::min(ages[f], most[t]);
  }
  return ages;
}

std::vector<std::uint8_t> Kept::surface(std::span<const double> control) const {
  if (!is_known()) return {};
  const auto channels = static_cast<std::size_t>(frame_.seen.picture.channels);
  std::vector<std::uint8_t> kept(functions_.size());
  for (FunctionIndex f = 0; f < kept.size(); ++f) {
    if (!functions_[f]) continue;
    const auto now = control.subspan(f * channels, channels);
    const auto before = before_.colours.control.begin() + static_cast<std::ptrdiff_t>(match_[f] * channels);
    kept[f] = std::equal(now.begin(), now.end(), before) ? 1 : 0;
  }
  std::vector<std::uint8_t> same = tiles_;
  const spline::PixelValues& values = frame_.values();
  for_tiles(values, [&](std::size_t t) { same[t] = same[t] && all_of(values.functions(t), kept) ? 1 : 0; });
  return same;
}

}  // namespace knotreel::track
