// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/pixel_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::spline {

namespace {

constexpr std::size_t kPieces = 256;       // that are looked at by one call of a parallel loop
constexpr std::size_t kTilesPerPiece = 8;  // that room is made for

constexpr double kRounding = 1e-9;  // of places that go by the corner

/// What holds the places of all pixels of a tile.
struct Box {
  Vec2 low;
  Vec2 high;
};

/// The largest value of an affine function in a box.
double largest(const Affine& a, const Box& box) {
  return a({a.nx > 0 ? box.high.x : box.low.x, a.ny > 0 ? box.high.y : box.low.y});
}

bool may_reach(const PieceTerm& term, const Box& box) {
  if (term.low.x > box.high.x || term.high.x < box.low.x || term.low.y > box.high.y ||
      term.high.y < box.low.y)
    return false;
  for (int i = 0; i < term.tent.slope_count; ++i) {
    if (largest(term.tent.slopes[static_cast<std::size_t>(i)], box) <= 0) return false;
  }
  for (int i = 0; i < term.tent.wall_count; ++i) {
    if (largest(term.tent.walls[static_cast<std::size_t>(i)], box) < -kOnWall) return false;
  }
  return true;
}

/// Tiles with their boxes.
class Boxes {
 public:
  /// @param slack around them.
  Boxes(const PixelTiles& tiles, Vec2 slack) : columns_(tiles.tile_columns()), rows_(tiles.tile_rows()) {
    const auto& mesh = tiles.basis().space().mesh();
    tile_ = {PixelTiles::kSide * mesh.width / tiles.width(),
             PixelTiles::kSide * mesh.height / tiles.height()};
    boxes_.resize(tiles.tile_count());
    std::vector<double> reach(rows_, 0.0);
    const Vec2 first = 0.5 / PixelTiles::kSide * tile_;
    const Vec2 last = tile_ - first;
    parallel_for(rows_, [&](std::size_t row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        const std::size_t t = row * columns_ + column;
        Box& box = boxes_[t];
        if (tiles.at_centres(t)) {
          const Vec2 corner = tiles.corner(t);
          box = {corner + first - slack, corner + last + slack};
          continue;
        }
        std::array<double, PixelTiles::kTilePixels> x;
        std::array<double, PixelTiles::kTilePixels> y;
        tiles.places(t, x.data(), y.data());
        const auto [left, right] = std::minmax_element(x.begin(), x.end());
        const auto [top, bottom] = std::minmax_element(y.begin(), y.end());
        const Vec2 corner = tiles.corner(t);
        box = {corner + Vec2{*left, *top} - slack, corner + Vec2{*right, *bottom} + slack};
        reach[row] = std::max({reach[row], corner.x - box.low.x, corner.y - box.low.y,
                               box.high.x - corner.x - tile_.x, box.high.y - corner.y - tile_.y});
      }
    });
    reach_ = *std::max_element(reach.begin(), reach.end());
  }

  /// Calls visit(tile) for the tiles, ascending, whose boxes meet one, and maybe others around.
  template <class Visit>
  void near(Vec2 low, Vec2 high, Visit&& visit) const {
    const auto index = [](double v, double size, std::size_t count) {
      return static_cast<std::size_t>(std::clamp(std::floor(v / size), 0.0, static_cast<double>(count - 1)));
    };
    const std::size_t left = index(low.x - reach_, tile_.x, columns_);
    const std::size_t right = index(high.x + reach_, tile_.x, columns_);
    const std::size_t bottom = index(high.y + reach_, tile_.y, rows_);
    for (std::size_t row = index(low.y - reach_, tile_.y, rows_); row <= bottom; ++row) {
      for (std::size_t column = left; column <= right; ++column) visit(row * columns_ + column);
    }
  }

  const Box& operator[](std::size_t tile) const { return boxes_[tile]; }

 private:
  std::size_t columns_;
  std::size_t rows_;
  Vec2 tile_;  ///< its size
  std::vector<Box> boxes_;
  double reach_ = 0;  ///< how far any box reaches out of its tile
};

}  // namespace

PixelTiles::PixelTiles(const Basis& basis, int width, int height, std::span<const Vec2> places,
                       std::span<const std::uint8_t> wanted, double slack)
    : basis_(&basis),
      width_(width),
      height_(height),
      places_(places),
      tile_columns_(static_cast<std::size_t>((width + kSide - 1) / kSide)),
      tile_rows_(static_cast<std::size_t>((height + kSide - 1) / kSide)) {
  if (width < 1 || height < 1) throw Error(ErrorKind::kInvalidArgument, "a picture has at least one pixel");
  if (!places.empty() && places.size() != std::size_t(width) * std::size_t(height))
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one place per pixel");
  if (!wanted.empty() && wanted.size() != basis.space().function_count())
    throw Error(ErrorKind::kInvalidArgument, "functions are wanted by one flag per function");
  cell_width_ = basis.space().mesh().width / width;
  cell_height_ = basis.space().mesh().height / height;
  for (std::size_t i = 0; i < kTilePixels; ++i) {
    centre_x_[i] = (static_cast<double>(i % kSide) + 0.5) * cell_width_;
    centre_y_[i] = (static_cast<double>(i / kSide) + 0.5) * cell_height_;
    centres_[i] = static_cast<float>(centre_x_[i]);
    centres_[kTilePixels + i] = static_cast<float>(centre_y_[i]);
  }
  find_moved();
  list_pieces(wanted, slack);
}

PixelTiles::Tile PixelTiles::tile(std::size_t index) const {
  const int left = static_cast<int>(index % tile_columns_) * kSide;
  const int top = static_cast<int>(index / tile_columns_) * kSide;
  return {left, top, std::min(left + kSide, width_), std::min(top + kSide, height_)};
}

Vec2 PixelTiles::corner(std::size_t tile) const {
  return {static_cast<double>(tile % tile_columns_) * kSide * cell_width_,
          static_cast<double>(tile / tile_columns_) * kSide * cell_height_};
}

bool PixelTiles::is_moved(std::size_t index) const {
  const Tile tile = this->tile(index);
  for (int y = tile.top; y < tile.bottom; ++y) {
    const Vec2* p = places_.data() + static_cast<std::size_t>(y) * std::size_t(width_);
    const double centre = (y + 0.5) * cell_height_;
    for (int x = tile.left; x < tile.right; ++x) {
      if (p[x].x != (x + 0.5) * cell_width_ || p[x].y != centre) return true;
    }
  }
  return false;
}

void PixelTiles::find_moved() {
  moved_.assign(tile_count(), kAtCentres);
  if (places_.empty()) return;
  const auto for_tiles = [&](auto&& visit) {
    parallel_for(tile_rows_, [&](std::size_t row) {
      for (std::size_t t = row * tile_columns_; t < (row + 1) * tile_columns_; ++t) visit(t);
    });
  };
  for_tiles([&](std::size_t t) { moved_[t] = is_moved(t) ? 0 : kAtCentres; });
  std::uint32_t count = 0;
  for (std::uint32_t& m : moved_) m = m == kAtCentres ? m : count++;
  near_.resize(count);
  for_tiles([&](std::size_t t) {
    if (moved_[t] == kAtCentres) return;
    std::array<double, 2 * kTilePixels> exact;
    places(t, exact.data(), exact.data() + kTilePixels);
    std::transform(exact.begin(), exact.end(), near_[moved_[t]].begin(),
                   [](double v) { return static_cast<float>(v); });
  });
}

void PixelTiles::places(std::size_t tile, double* x, double* y) const {
  if (at_centres(tile)) {
    std::copy(centre_x_.begin(), centre_x_.end(), x);
    std::copy(centre_y_.begin(), centre_y_.end(), y);
    return;
  }
  const Vec2 origin = corner(tile);
  const Tile at = this->tile(tile);
  for (int j = 0; j < kSide; ++j) {
    const Vec2* row =
        places_.data() + static_cast<std::size_t>(std::min(at.top + j, at.bottom - 1)) * std::size_t(width_);
    for (int i = 0; i < kSide; ++i) {
      const Vec2 p = row[std::min(at.left + i, at.right - 1)];
      *x++ = p.x - origin.x;
      *y++ = p.y - origin.y;
    }
  }
}

void PixelTiles::list_pieces(std::span<const std::uint8_t> wanted, double slack) {
  struct Hit {
    std::uint32_t tile;
    std::uint32_t piece;
  };
  const Boxes boxes(*this, {slack + kRounding, slack + kRounding});
  const PieceSet& set = basis_->pieces();
  std::vector<std::vector<Hit>> blocks((set.pieces.size() + kPieces - 1) / kPieces);
  parallel_for(blocks.size(), [&](std::size_t block) {
    blocks[block].reserve(kTilesPerPiece * kPieces);
    for (std::size_t p = block * kPieces; p < std::min(set.pieces.size(), (block + 1) * kPieces); ++p) {
      const Piece& piece = set.pieces[p];
      const auto terms = std::span(set.terms).subspan(piece.term_begin, piece.term_end - piece.term_begin);
      const bool counts = std::any_of(piece.functions.begin(), piece.functions.end(), [&](FunctionIndex f) {
        return f != kNoFunction && (wanted.empty() || wanted[f]);
      });
      if (terms.empty() || !counts) continue;
      // All terms of a piece have the same box.
      boxes.near(terms.front().low, terms.front().high, [&](std::size_t t) {
        const auto reaches = [&](const PieceTerm& term) { return may_reach(term, boxes[t]); };
        if (std::any_of(terms.begin(), terms.end(), reaches))
          blocks[block].push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(p)});
      });
    }
  });
  piece_begin_.assign(tile_count() + 1, 0);
  for (const auto& hits : blocks) {
    for (const Hit& hit : hits) ++piece_begin_[hit.tile + 1];
  }
  std::partial_sum(piece_begin_.begin(), piece_begin_.end(), piece_begin_.begin());
  pieces_.resize(piece_begin_.back());
  std::vector<std::size_t> end(piece_begin_.begin(), piece_begin_.end() - 1);
  for (const auto& hits : blocks) {
    for (const Hit& hit : hits) pieces_[end[hit.tile]++] = hit.piece;
  }
}

}  // namespace knotreel::spline
