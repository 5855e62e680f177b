// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/pixel_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/small_vector.h"
#include "fit/geometry_map.h"
#include "fit/pixel_centre.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/surface.h"

namespace knotreel::fit {

namespace {

using spline::PixelTiles;

// The displacement changes by less than a fifth of a pixel per pixel nearly everywhere, so each rough step
// leaves less than a fifth of the way.
constexpr int kRoughSteps = 4;
constexpr float kShortStep = 0.02F;  // pixels; the last rough one
constexpr double kExact = 3e-4;      // pixels
constexpr double kInvertible = 0.3;  // area of the map from which on its inverse is of use

/// Displacements of all pixels, row-major.
struct Offset {
  float x = 0;
  float y = 0;

  bool operator==(const Offset&) const = default;
};
using Offsets = std::vector<Offset>;

using Surface = spline::TileSurface<float>;

Offset offset_at(const Surface& surface, std::size_t place) {
  return {surface[place], surface[PixelTiles::kTilePixels + place]};
}

/// S_geo(u) - u at all pixels at once.
class Displacements {
 public:
  Displacements(const spline::Basis& basis, std::span<const Vec2> displacement, int width, int height,
                const KnownPlaces& known)
      : basis_(basis),
        width_(width),
        height_(height),
        known_(known),
        control_(displacement_control(basis.space(), displacement)) {
    displaced_.reserve(basis.space().function_count());
    for (const std::uint32_t g : basis.space().geometry_of()) displaced_.push_back(displacement[g] != Vec2{});
    for (std::size_t f = 0; f < known.functions.size(); ++f)
      displaced_[f] = displaced_[f] && known.functions[f] ? 1 : 0;
  }

  /// Calls visit(tiles, tile, surface of the displacement) for all tiles but those without any displacement,
  /// and those of which more is known than `most`: in any order, on all threads allowed, those of a row of
  /// tiles one after the other.
  /// @param places none: the centres. Those of a tile may be changed by its visit.
  /// @param slack of the tiles.
  template <class Visit>
  void for_tiles(std::span<const Vec2> places, double slack, PlacesOfTile most, Visit&& visit) const {
    const PixelTiles tiles(basis_, width_, height_, places, displaced_, slack);
    std::vector<std::uint8_t> skipped(tiles.tile_count());
    for (std::size_t t = 0; t < skipped.size(); ++t) {
      const bool is_known = !known_.tiles.empty() && known_.tiles[t] > most;
      skipped[t] = is_known || (tiles.pieces(t).empty() && tiles.at_centres(t)) ? 1 : 0;
    }
    spline::for_surface_tiles<float>(
        tiles, control(), [&](std::size_t t, const Surface& surface) { visit(tiles, t, surface); }, skipped);
  }

  spline::Control control() const { return {control_, 2}; }

  /// At the centres, row-major; none where it is not needed.
  Offsets at_centres() const {
    Offsets offsets(std::size_t(width_) * std::size_t(height_));
    for_tiles(
        {}, 0, PlacesOfTile::kKnown, [&](const PixelTiles& tiles, std::size_t t, const Surface& surface) {
          tiles.for_pixels(
              t, [&](std::size_t pixel, std::size_t place) { offsets[pixel] = offset_at(surface, place); });
        });
    return offsets;
  }

 private:
  const spline::Basis& basis_;
  int width_;
  int height_;
  KnownPlaces known_;
  std::vector<double> control_;
  std::vector<std::uint8_t> displaced_;  ///< functions: few, those near features
};

/// A displacement known at the pixel centres, bilinear between them.
class Grid {
 public:
  Grid(Offsets offsets, int width, int height)
      : offsets_(std::move(offsets)), width_(width), height_(height) {}

  Offset of(std::size_t pixel) const { return offsets_[pixel]; }

  /// At a place, and its derivatives.
  struct Value {
    Offset at, by_x, by_y;
  };
  Value value(float px, float py) const {
    const float x = std::clamp(px - 0.5F, 0.0F, static_cast<float>(width_ - 1));
    const float y = std::clamp(py - 0.5F, 0.0F, static_cast<float>(height_ - 1));
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    const Offset* const upper = offsets_.data() + std::size_t(y0) * std::size_t(width_) + std::size_t(x0);
    const Offset* const lower = y0 + 1 < height_ ? upper + width_ : upper;
    const std::size_t next = x0 + 1 < width_ ? 1 : 0;
    const Offset a = upper[0], b = upper[next], c = lower[0], d = lower[next];
    const float fx = x - static_cast<float>(x0);
    const float fy = y - static_cast<float>(y0);
    const auto mix = [](float t, Offset p, Offset q) {
      return Offset{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
    };
    const auto difference = [](Offset p, Offset q) { return Offset{q.x - p.x, q.y - p.y}; };
    const Offset left = mix(fy, a, c);
    const Offset right = mix(fy, b, d);
    return {mix(fx, left, right), difference(left, right), difference(mix(fx, a, b), mix(fx, c, d))};
  }

  /// How much the derivatives change around a pixel, per pixel.
  float bend(int x, int y) const {
    const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x);
    const std::size_t left = i - (x > 0), right = i + (x + 1 < width_);
    const std::size_t up = y > 0 ? i - std::size_t(width_) : i;
    const std::size_t down = y + 1 < height_ ? i + std::size_t(width_) : i;
    const auto second = [&](std::size_t a, std::size_t b) {
      return std::abs(offsets_[a].x + offsets_[b].x - 2 * offsets_[i].x) +
             std::abs(offsets_[a].y + offsets_[b].y - 2 * offsets_[i].y);
    };
    return second(left, right) + second(up, down);
  }

 private:
  Offsets offsets_;
  int width_;
  int height_;
};

/// The places of the pixels of one picture, made better and better.
class Search {
 public:
  Search(const spline::Basis& basis, std::span<const Vec2> displacement, int width, int height,
         const KnownPlaces& known)
      : width_(width),
        height_(height),
        known_(known),
        map_(basis, displacement),
        displacements_(basis, displacement, width, height, known),
        grid_(displacements_.at_centres(), width, height),
        places_(std::size_t(width) * std::size_t(height)) {}

  std::vector<Vec2> run() {
    start();
    step_together();
    step_one_by_one();
    return std::move(places_);
  }

 private:
  bool is_known(std::size_t x, std::size_t y) const {
    constexpr std::size_t kSide = PixelTiles::kSide;
    const std::size_t columns = (std::size_t(width_) + kSide - 1) / kSide;
    return !known_.tiles.empty() && known_.tiles[y / kSide * columns + x / kSide] != PlacesOfTile::kUnknown;
  }

  /// A step of Newton's method with the derivatives of the grid.
  Vec2 step(Vec2 place, Vec2 miss) const {
    const Grid::Value v = grid_.value(static_cast<float>(place.x), static_cast<float>(place.y));
    const Vec2 ex{1 + static_cast<double>(v.by_x.x), static_cast<double>(v.by_x.y)};
    const Vec2 ey{static_cast<double>(v.by_y.x), 1 + static_cast<double>(v.by_y.y)};
    const double area = cross(ex, ey);
    if (area < kInvertible) return miss;
    return {cross(miss, ey) / area, cross(ex, miss) / area};
  }

  /// Right but for a few hundredths of a pixel next to features, where the displacement bends.
  void start() {
    parallel_for(static_cast<std::size_t>(height_), [&](std::size_t y) {
      for (std::size_t x = 0; x < std::size_t(width_); ++x) {
        const std::size_t i = y * std::size_t(width_) + x;
        if (is_known(x, y)) {
          places_[i] = known_.places[i];
          continue;
        }
        places_[i] = pixel_centre(x, y);
        Offset offset = grid_.of(i);
        if (offset == Offset{}) continue;
        const float cx = static_cast<float>(x) + 0.5F;
        const float cy = static_cast<float>(y) + 0.5F;
        for (int n = 1; n < kRoughSteps; ++n) {
          const Offset next = grid_.value(cx - offset.x, cy - offset.y).at;
          const bool is_short =
              std::abs(next.x - offset.x) < kShortStep && std::abs(next.y - offset.y) < kShortStep;
          offset = next;
          if (is_short) break;
        }
        places_[i] = map_.clamped(places_[i] - Vec2{offset.x, offset.y});
      }
    });
  }

  /// Steps from where the surface takes the places: one for all pixels, and more for those that it leaves too
  /// far off.
  void step_together() {
    std::vector<std::vector<std::uint32_t>> far(std::size_t(height_ + PixelTiles::kSide - 1) /
                                                PixelTiles::kSide);
    displacements_.for_tiles(places_, kSlack, PlacesOfTile::kUnknown,
                             [&](const PixelTiles& tiles, std::size_t t, const Surface& surface) {
                               FarPixels left = step_in_tile(tiles, t, surface);
                               for (int round = 0; round < kRounds && !left.empty(); ++round)
                                 step_again(tiles, t, left);
                               auto& row = far[t / tiles.tile_columns()];
                               for (const FarPixel& p : left) row.push_back(p.pixel);
                             });
    for (const auto& row : far) far_.insert(far_.end(), row.begin(), row.end());
  }

  struct FarPixel {
    std::uint32_t pixel;
    Vec2 listed;  ///< the place that the tile was made for
  };
  using FarPixels = SmallVector<FarPixel, PixelTiles::kTilePixels>;

  /// @return the pixels that are still too far off.
  FarPixels step_in_tile(const PixelTiles& tiles, std::size_t t, const Surface& surface) {
    FarPixels far;
    const PixelTiles::Tile tile = tiles.tile(t);
    for (int y = tile.top; y < tile.bottom; ++y) {
      auto place = std::size_t(y - tile.top) * PixelTiles::kSide;
      for (int x = tile.left; x < tile.right; ++x, ++place) {
        const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x);
        const Vec2 from = places_[i];
        const Vec2 miss =
            pixel_centre(std::size_t(x), std::size_t(y)) - image(from, offset_at(surface, place));
        if (miss == Vec2{}) continue;
        places_[i] = map_.clamped(from + step(from, miss));
        if (dot(miss, miss) <= kExact * kExact) continue;
        const auto bend = static_cast<double>(grid_.bend(x, y));
        if (norm(miss) * std::min(1.0, kLeastBend + bend) > kExact)
          far.push_back({static_cast<std::uint32_t>(i), from});
      }
    }
    return far;
  }

  /// Another step of those that the pieces of the tile tell of; the others, and what is too far off, are
  /// left.
  void step_again(const PixelTiles& tiles, std::size_t t, FarPixels& far) {
    std::array<Vec2, PixelTiles::kTilePixels> places;
    places.fill(places_[far.front().pixel]);
    for (std::size_t k = 0; k < far.size(); ++k) places[k] = places_[far[k].pixel];
    Surface surface;
    spline::surface_of_tile<float>(tiles, t, places, displacements_.control(), surface);
    std::size_t left = 0;
    for (std::size_t k = 0; k < far.size(); ++k) {
      const FarPixel p = far[k];
      const Vec2 gone = places[k] - p.listed;
      const bool is_near = std::max(std::abs(gone.x), std::abs(gone.y)) <= kSlack;
      const Vec2 miss = centre_of_pixel(p.pixel, width_) - image(places[k], offset_at(surface, k));
      if (is_near) places_[p.pixel] = map_.clamped(places[k] + step(places[k], miss));
      if (!is_near || norm(miss) > kExact) far[left++] = p;
    }
    far.resize(left);
  }

  static Vec2 image(Vec2 place, Offset offset) { return place + Vec2{offset.x, offset.y}; }

  /// What is left, with the derivatives of the surface, and care.
  void step_one_by_one() {
    parallel_for((far_.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t k = block * kBlock; k < std::min((block + 1) * kBlock, far_.size()); ++k)
        places_[far_[k]] = map_.place_of(centre_of_pixel(far_[k], width_), places_[far_[k]]);
    });
  }

  static constexpr int kRounds = 3;
  static constexpr double kSlack = 0.3;       ///< pixels
  static constexpr double kLeastBend = 0.02;  ///< that is reckoned with, pixels per pixel
  static constexpr std::size_t kBlock = 64;

  int width_;
  int height_;
  KnownPlaces known_;
  GeometryMap map_;
  Displacements displacements_;
  Grid grid_;
  std::vector<Vec2> places_;
  std::vector<std::uint32_t> far_;  ///< pixels
};

}  // namespace

std::vector<Vec2> pixel_places(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                               int height, const KnownPlaces& known) {
  return Search(basis, displacement, width, height, known).run();
}

std::shared_ptr<const spline::PlacedBasis> place_basis(std::shared_ptr<const spline::Basis> basis,
                                                       std::span<const Vec2> displacement,
                                                       const KnownPlaces& known) {
  const mesh::KnotMesh& mesh = basis->space().mesh();
  const int width = static_cast<int>(std::lround(mesh.width));
  const int height = static_cast<int>(std::lround(mesh.height));
  const bool is_identity =
      std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; });
  std::vector<Vec2> places;
  if (!is_identity || !mesh.segments.empty())
    places = pixel_places(*basis, displacement, width, height, known);
  return std::make_shared<const spline::PlacedBasis>(std::move(basis), width, height, std::move(places));
}

}  // namespace knotreel::fit
