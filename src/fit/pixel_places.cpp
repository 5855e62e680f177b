#include "knotreel/fit/pixel_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fit/geometry_map.h"
#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"
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

  /// Calls visit(x, y, offset) for all pixels but those in tiles where there is no displacement, or more is
  /// known than `most`: tiles in any order, on all threads allowed.
  /// @param places none: the centres. Those of a tile may be changed by the visits of its pixels.
  template <class Visit>
  void for_pixels(std::span<const Vec2> places, PlacesOfTile most, Visit&& visit) const {
    const PixelTiles tiles(basis_, width_, height_, places, displaced_);
    std::vector<std::uint8_t> skipped(tiles.tile_count());
    for (std::size_t t = 0; t < skipped.size(); ++t) {
      const bool is_known = !known_.tiles.empty() && known_.tiles[t] > most;
      skipped[t] = is_known || (tiles.pieces(t).empty() && tiles.at_centres(t)) ? 1 : 0;
    }
    const auto visit_tile = [&](std::size_t t, const spline::TileSurface<float>& surface) {
      const PixelTiles::Tile tile = tiles.tile(t);
      for (int y = tile.top; y < tile.bottom; ++y) {
        auto place = static_cast<std::size_t>((y - tile.top) * PixelTiles::kSide);
        for (int x = tile.left; x < tile.right; ++x, ++place)
          visit(x, y, Offset{surface[place], surface[PixelTiles::kTilePixels + place]});
      }
    };
    spline::for_surface_tiles<float>(tiles, {control_, 2}, visit_tile, skipped);
  }

  /// At the centres, row-major; none where it is not needed.
  Offsets at_centres() const {
    Offsets offsets(std::size_t(width_) * std::size_t(height_));
    for_pixels({}, PlacesOfTile::kKnown, [&](int x, int y, Offset offset) {
      offsets[std::size_t(y) * std::size_t(width_) + std::size_t(x)] = offset;
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
      : basis_(basis),
        displacement_(displacement),
        width_(width),
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
  static Vec2 centre(std::size_t x, std::size_t y) {
    return {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
  }
  Vec2 centre(std::size_t pixel) const {
    return centre(pixel % std::size_t(width_), pixel / std::size_t(width_));
  }

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
        places_[i] = centre(x, y);
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

  /// A step from where the surface takes the places, and which it leaves too far off.
  void step_together() {
    std::vector<std::vector<std::uint32_t>> far(static_cast<std::size_t>(height_));
    displacements_.for_pixels(places_, PlacesOfTile::kUnknown, [&](int x, int y, Offset offset) {
      const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x);
      const Vec2 miss = centre(std::size_t(x), std::size_t(y)) - (places_[i] + Vec2{offset.x, offset.y});
      if (miss == Vec2{}) return;
      places_[i] = map_.clamped(places_[i] + step(places_[i], miss));
      if (dot(miss, miss) <= kExact * kExact) return;
      const auto bend = static_cast<double>(grid_.bend(x, y));
      if (norm(miss) * std::min(1.0, kLeastBend + bend) > kExact)
        far[std::size_t(y)].push_back(static_cast<std::uint32_t>(i));
    });
    for (const auto& row : far) far_.insert(far_.end(), row.begin(), row.end());
  }

  /// More steps for the pixels that are far off; in the end with the derivatives of the surface, and care.
  void step_one_by_one() {
    for (int round = 0; round < kRounds && !far_.empty(); ++round) {
      std::vector<Vec2> points;
      points.reserve(far_.size());
      for (const std::uint32_t i : far_) points.push_back(places_[i]);
      const std::vector<Vec2> images = image_points(basis_, displacement_, std::move(points));
      std::size_t left = 0;
      for (std::size_t k = 0; k < images.size(); ++k) {
        const std::uint32_t i = far_[k];
        const Vec2 miss = centre(i) - images[k];
        places_[i] = map_.clamped(places_[i] + step(places_[i], miss));
        if (norm(miss) > 2 * kExact) far_[left++] = i;
      }
      far_.resize(left);
    }
    parallel_for((far_.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t k = block * kBlock; k < std::min((block + 1) * kBlock, far_.size()); ++k)
        places_[far_[k]] = map_.place_of(centre(far_[k]), places_[far_[k]]);
    });
  }

  static constexpr int kRounds = 2;
  static constexpr double kLeastBend = 0.02;  ///< that is reckoned with, pixels per pixel
  static constexpr std::size_t kBlock = 64;

  const spline::Basis& basis_;
  std::span<const Vec2> displacement_;
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
