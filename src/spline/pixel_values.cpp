#include "knotreel/spline/pixel_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "spline/plane.h"
#include "spline/tent.h"

namespace knotreel::spline {

namespace {

constexpr std::size_t kPixels = PixelValues::kTilePixels;
constexpr std::size_t kPieces = 256;  // that are looked at by one call of a parallel loop

constexpr Vec2 kSlack{1e-9, 1e-9};  // around boxes, for the rounding of places that go by the corner

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
  explicit Boxes(const PixelValues& values) : columns_(values.tile_columns()) {
    const auto& mesh = values.basis().space().mesh();
    tile_ = {PixelValues::kSide * mesh.width / values.width(),
             PixelValues::kSide * mesh.height / values.height()};
    boxes_.resize(values.tile_count());
    rows_ = boxes_.size() / columns_;
    std::vector<double> reach(rows_, 0.0);
    const Vec2 first = 0.5 / PixelValues::kSide * tile_;
    const Vec2 last = tile_ - first;
    parallel_for(rows_, [&](std::size_t row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        const std::size_t t = row * columns_ + column;
        Box& box = boxes_[t];
        if (values.at_centres(t)) {
          const Vec2 corner = values.corner(t);
          box = {corner + first - kSlack, corner + last + kSlack};
          continue;
        }
        std::array<double, kPixels> x;
        std::array<double, kPixels> y;
        values.places(t, x.data(), y.data());
        const auto [left, right] = std::minmax_element(x.begin(), x.end());
        const auto [top, bottom] = std::minmax_element(y.begin(), y.end());
        const Vec2 corner = values.corner(t);
        box = {corner + Vec2{*left, *top} - kSlack, corner + Vec2{*right, *bottom} + kSlack};
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
  std::size_t rows_ = 0;
  Vec2 tile_;  ///< its size
  std::vector<Box> boxes_;
  double reach_ = 0;  ///< how far any box reaches out of its tile
};

/// Where the shares of the three functions of a piece go.
template <class Value>
using Shares = std::array<Value*, 3>;

/// S: number of slopes, 0 for the constant tents of degree 1. Inlined into each version of add_term.
template <int S, bool Walls, bool Factor, class Value>
[[gnu::always_inline]] inline void term_loop(const Piece& piece, const PieceTerm& term, Vec2 origin,
                                             const Value* __restrict x, const Value* __restrict y,
                                             const Shares<Value>& out) {
  using Plane = PlaneIn<Value>;
  const auto plane = [origin](const Affine& a) {
    return Plane{static_cast<Value>(a(origin)), static_cast<Value>(a.nx), static_cast<Value>(a.ny)};
  };
  const std::array<Affine, 4>& slopes = term.tent.slopes;
  Plane s0, s1, s2, s3;
  if constexpr (S > 0) s0 = plane(slopes[0]);
  if constexpr (S > 1) s1 = plane(slopes[1]);
  if constexpr (S > 2) s2 = plane(slopes[2]);
  if constexpr (S > 3) s3 = plane(slopes[3]);
  std::array<Plane, 3> walls{Plane{1, 0, 0}, Plane{1, 0, 0}, Plane{1, 0, 0}};  // those missing: far away
  if constexpr (Walls) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i)
      walls[i] = plane(term.tent.walls[i]);
  }
  const Plane a0 = walls[0], a1 = walls[1], a2 = walls[2];
  const auto constant = static_cast<Value>(term.tent.constant);
  const Plane factor = Factor ? plane(term.factor) : Plane{};
  const Plane w0 = plane(piece.weights[0]);
  const Plane w1 = plane(piece.weights[1]);
  const Plane w2 = plane(piece.weights[2]);
  Value* __restrict out0 = out[0];
  Value* __restrict out1 = out[1];
  Value* __restrict out2 = out[2];
  for (std::size_t i = 0; i < kPixels; ++i) {
    const Value ux = x[i];
    const Value uy = y[i];
    const auto at = [ux, uy](const Plane& p) { return p.c + p.x * ux + p.y * uy; };
    Value v = constant;
    if constexpr (S > 0) v = at(s0);
    if constexpr (S > 1) v = at(s1) < v ? at(s1) : v;
    if constexpr (S > 2) v = at(s2) < v ? at(s2) : v;
    if constexpr (S > 3) v = at(s3) < v ? at(s3) : v;
    v = v > 0 ? v : 0;
    if constexpr (Walls) {
      const Value d01 = at(a1) < at(a0) ? at(a1) : at(a0);
      const Value d = at(a2) < d01 ? at(a2) : d01;
      v = d > 0 ? v : 0;
    }
    if constexpr (Factor) v *= at(factor);
    Value b0 = at(w0);
    Value b1 = at(w1);
    Value b2 = at(w2);
    if constexpr (S == 0) {
      // A point counts as inside the closed face, so a negative coordinate is the tolerance of a wall.
      b0 = b0 < 0 ? 0 : b0;
      b1 = b1 < 0 ? 0 : b1;
      b2 = b2 < 0 ? 0 : b2;
    }
    out0[i] += v * b0;
    out1[i] += v * b1;
    out2[i] += v * b2;
  }
}

template <bool Walls, bool Factor, class Value>
[[gnu::always_inline]] inline void term_by_slopes(const Piece& piece, const PieceTerm& term, Vec2 origin,
                                                  const Value* x, const Value* y, const Shares<Value>& out) {
  switch (term.tent.slope_count) {
    case 0:
      return term_loop<0, Walls, Factor>(piece, term, origin, x, y, out);
    case 1:
      return term_loop<1, Walls, Factor>(piece, term, origin, x, y, out);
    case 2:
      return term_loop<2, Walls, Factor>(piece, term, origin, x, y, out);
    case 3:
      return term_loop<3, Walls, Factor>(piece, term, origin, x, y, out);
    default:
      return term_loop<4, Walls, Factor>(piece, term, origin, x, y, out);
  }
}

template <class Value>
[[gnu::always_inline]] inline void term_by_parts(const Piece& piece, const PieceTerm& term, Vec2 origin,
                                                 const Value* x, const Value* y, const Shares<Value>& out) {
  if (term.has_factor) {
    if (term.tent.wall_count > 0) return term_by_slopes<true, true>(piece, term, origin, x, y, out);
    return term_by_slopes<false, true>(piece, term, origin, x, y, out);
  }
  if (term.tent.wall_count > 0) return term_by_slopes<true, false>(piece, term, origin, x, y, out);
  return term_by_slopes<false, false>(piece, term, origin, x, y, out);
}

/// Adds the shares of a term at the pixels of a tile, none of which is on a wall.
/// @param x, y relative to the origin.
KNOTREEL_MULTIVERSION
void add_term(const Piece& piece, const PieceTerm& term, Vec2 origin, const double* x, const double* y,
              const Shares<double>& out) {
  term_by_parts(piece, term, origin, x, y, out);
}
KNOTREEL_MULTIVERSION
void add_term(const Piece& piece, const PieceTerm& term, Vec2 origin, const float* x, const float* y,
              const Shares<float>& out) {
  term_by_parts(piece, term, origin, x, y, out);
}

/// Distance of a wall, pixels, from which on the precision tells on which side a point is.
template <class Value>
constexpr double kClearOfWall = std::is_same_v<Value, double> ? 2 * kOnWall : 1e-4;

/// Whether some pixel is nearer to a wall of a tent that has some.
KNOTREEL_MULTIVERSION
bool any_on_wall(const Tent& tent, Vec2 origin, const double* x, const double* y, double clear) {
  constexpr std::size_t kLanes = 8;
  for (std::size_t w = 0; w < static_cast<std::size_t>(tent.wall_count); ++w) {
    const Plane wall = plane_of(tent.walls[w], origin);
    std::array<double, kLanes> nearest;
    nearest.fill(std::numeric_limits<double>::max());
    for (std::size_t i = 0; i < kPixels; i += kLanes) {
      for (std::size_t l = 0; l < kLanes; ++l) {
        const double d = std::abs(wall.c + wall.x * x[i + l] + wall.y * y[i + l]);
        nearest[l] = d < nearest[l] ? d : nearest[l];
      }
    }
    if (*std::min_element(nearest.begin(), nearest.end()) <= clear) return true;
  }
  return false;
}

/// The same as add_term() for pixels anywhere, one by one.
template <class Value>
void add_one_by_one(const Piece& piece, const PieceTerm& term, Vec2 origin, const mesh::KnotMesh& mesh,
                    const double* x, const double* y, const Shares<Value>& out) {
  for (std::size_t i = 0; i < kPixels; ++i) {
    const Vec2 u = origin + Vec2{x[i], y[i]};
    double v = tent_value(term.tent, u, inward_direction(u, mesh.width, mesh.height));
    if (v == 0) continue;
    if (term.has_factor) v *= term.factor(u);
    const double lowest = term.tent.slope_count == 0 ? 0 : -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k)
      out[k][i] += static_cast<Value>(v * std::max(piece.weights[k](u), lowest));
  }
}

template <class Value>
[[gnu::always_inline]] inline void sum_functions(const Value* values,
                                                 std::span<const FunctionIndex> functions,
                                                 const double* control, std::size_t channels,
                                                 Value* __restrict sums) {
  for (const FunctionIndex f : functions) {
    for (std::size_t c = 0; c < channels; ++c) {
      const auto weight = static_cast<Value>(control[f * channels + c]);
      Value* __restrict to = sums + c * kPixels;
      for (std::size_t i = 0; i < kPixels; ++i) to[i] += values[i] * weight;
    }
    values += kPixels;
  }
}

/// sums[c][i] += value[i] * control[c] for the functions of a tile, whose values are one after the other.
KNOTREEL_MULTIVERSION
void add_functions(const double* values, std::span<const FunctionIndex> functions, const double* control,
                   std::size_t channels, double* __restrict sums) {
  sum_functions(values, functions, control, channels, sums);
}
KNOTREEL_MULTIVERSION
void add_functions(const float* values, std::span<const FunctionIndex> functions, const double* control,
                   std::size_t channels, float* __restrict sums) {
  sum_functions(values, functions, control, channels, sums);
}

}  // namespace

PixelValues::PixelValues(const Basis& basis, int width, int height, std::span<const Vec2> places,
                         std::span<const std::uint8_t> wanted)
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
  list_entries(wanted);
  name_functions(wanted);
}

PixelValues::Tile PixelValues::tile(std::size_t index) const {
  const int left = static_cast<int>(index % tile_columns_) * kSide;
  const int top = static_cast<int>(index / tile_columns_) * kSide;
  return {left, top, std::min(left + kSide, width_), std::min(top + kSide, height_)};
}

Vec2 PixelValues::corner(std::size_t tile) const {
  return {static_cast<double>(tile % tile_columns_) * kSide * cell_width_,
          static_cast<double>(tile / tile_columns_) * kSide * cell_height_};
}

bool PixelValues::is_moved(std::size_t index) const {
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

void PixelValues::find_moved() {
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
    std::array<double, 2 * kPixels> exact;
    places(t, exact.data(), exact.data() + kPixels);
    std::transform(exact.begin(), exact.end(), near_[moved_[t]].begin(),
                   [](double v) { return static_cast<float>(v); });
  });
}

void PixelValues::places(std::size_t tile, double* x, double* y) const {
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

void PixelValues::list_entries(std::span<const std::uint8_t> wanted) {
  struct Hit {
    std::uint32_t tile;
    std::uint32_t piece;
  };
  const Boxes boxes(*this);
  const PieceSet& set = basis_->pieces();
  std::vector<std::vector<Hit>> blocks((set.pieces.size() + kPieces - 1) / kPieces);
  parallel_for(blocks.size(), [&](std::size_t block) {
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
  entry_begin_.assign(tile_count() + 1, 0);
  for (const auto& hits : blocks) {
    for (const Hit& hit : hits) ++entry_begin_[hit.tile + 1];
  }
  std::partial_sum(entry_begin_.begin(), entry_begin_.end(), entry_begin_.begin());
  entries_.resize(entry_begin_.back());
  std::vector<std::size_t> end(entry_begin_.begin(), entry_begin_.end() - 1);
  for (const auto& hits : blocks) {
    for (const Hit& hit : hits) entries_[end[hit.tile]++].piece = hit.piece;
  }
}

void PixelValues::name_functions(std::span<const std::uint8_t> wanted) {
  const std::size_t function_count = basis_->space().function_count();
  std::vector<std::vector<FunctionIndex>> by_row(tile_rows_);
  function_begin_.assign(tile_count() + 1, 0);
  parallel_for(tile_rows_, [&](std::size_t row) {
    std::vector<FunctionIndex>& all = by_row[row];
    std::vector<std::uint32_t> slot(function_count, kNoSlot);
    for (std::size_t t = row * tile_columns_; t < (row + 1) * tile_columns_; ++t) {
      const auto reaching =
          std::span(entries_).subspan(entry_begin_[t], entry_begin_[t + 1] - entry_begin_[t]);
      const std::size_t first = all.size();
      for (const Entry& e : reaching) {
        for (const FunctionIndex f : basis_->pieces().pieces[e.piece].functions) {
          if (f == kNoFunction || slot[f] != kNoSlot || (!wanted.empty() && !wanted[f])) continue;
          slot[f] = 0;
          all.push_back(f);
        }
      }
      std::sort(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
      for (std::size_t i = first; i < all.size(); ++i) slot[all[i]] = static_cast<std::uint32_t>(i - first);
      for (Entry& e : reaching) {
        const auto& functions = basis_->pieces().pieces[e.piece].functions;
        for (std::size_t k = 0; k < 3; ++k)
          e.slots[k] = functions[k] == kNoFunction ? kNoSlot : slot[functions[k]];
      }
      for (std::size_t i = first; i < all.size(); ++i) slot[all[i]] = kNoSlot;
      function_begin_[t + 1] = all.size() - first;
    }
  });
  std::partial_sum(function_begin_.begin(), function_begin_.end(), function_begin_.begin());
  functions_.reserve(function_begin_.back());
  for (const auto& row : by_row) functions_.insert(functions_.end(), row.begin(), row.end());
}

template <class Value>
void PixelValues::evaluate_in(std::size_t index, Value* values) const {
  const PieceSet& set = basis_->pieces();
  const std::size_t count = functions(index).size();
  const Vec2 origin = corner(index);
  // Single precision needs the exact places only where there are walls.
  std::array<double, 2 * kPixels> exact;
  bool has_exact = false;
  const auto exact_places = [&] {
    if (!has_exact) places(index, exact.data(), exact.data() + kPixels);
    has_exact = true;
    return exact.data();
  };
  const Value* x;
  if constexpr (std::is_same_v<Value, float>) {
    x = places(index).data();
  } else {
    x = exact_places();
  }
  std::fill_n(values, count * kPixels, Value{0});
  std::array<Value, 3 * kPixels> nowhere;  // shares of functions that vanish or are not wanted
  nowhere.fill(0);
  for (const Entry& entry : entries(index)) {
    const Piece& piece = set.pieces[entry.piece];
    Shares<Value> out;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t slot = entry.slots[k];
      out[k] = slot == kNoSlot ? nowhere.data() + k * kPixels : values + std::size_t{slot} * kPixels;
    }
    for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
      const PieceTerm& term = set.terms[t];
      if (term.tent.wall_count > 0) {
        const double* e = exact_places();
        if (any_on_wall(term.tent, origin, e, e + kPixels, kClearOfWall<Value>)) {
          add_one_by_one(piece, term, origin, basis_->space().mesh(), e, e + kPixels, out);
          continue;
        }
      }
      add_term(piece, term, origin, x, x + kPixels, out);
    }
  }
  const Tile tile = this->tile(index);
  if (tile.pixels() == kSide * kSide) return;
  for (std::size_t f = 0; f < count; ++f) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        if (tile.left + i >= width_ || tile.top + j >= height_)
          values[f * kPixels + static_cast<std::size_t>(j * kSide + i)] = 0;
      }
    }
  }
}

void PixelValues::evaluate(std::size_t index, double* values) const {
  evaluate_in(index, values);
}
void PixelValues::evaluate(std::size_t index, float* values) const {
  evaluate_in(index, values);
}

template <class Value>
void surface_of_tile(const PixelValues& values, std::size_t tile, std::span<const double> control,
                     int channels, std::vector<Value>& memory, TileSurface<Value>& out) {
  const std::span<const FunctionIndex> functions = values.functions(tile);
  out.fill(0);
  if (functions.empty()) return;
  memory.resize(functions.size() * kPixels);
  values.evaluate(tile, memory.data());
  add_functions(memory.data(), functions, control.data(), static_cast<std::size_t>(channels), out.data());
}

template void surface_of_tile(const PixelValues&, std::size_t, std::span<const double>, int,
                              std::vector<double>&, TileSurface<double>&);
template void surface_of_tile(const PixelValues&, std::size_t, std::span<const double>, int,
                              std::vector<float>&, TileSurface<float>&);

template <class Value>
void for_surface_tiles(const PixelValues& values, std::span<const double> control, int channels,
                       const std::function<void(std::size_t, const TileSurface<Value>&)>& visit) {
  const std::size_t columns = values.tile_columns();
  parallel_for(values.tile_count() / columns, [&](std::size_t row) {
    std::vector<Value> memory;
    TileSurface<Value> surface;
    for (std::size_t t = row * columns; t < (row + 1) * columns; ++t) {
      surface_of_tile(values, t, control, channels, memory, surface);
      visit(t, surface);
    }
  });
}

template void for_surface_tiles(const PixelValues&, std::span<const double>, int,
                                const std::function<void(std::size_t, const TileSurface<double>&)>&);
template void for_surface_tiles(const PixelValues&, std::span<const double>, int,
                                const std::function<void(std::size_t, const TileSurface<float>&)>&);

template <class Value>
void surface_at_pixels(const PixelValues& values, std::span<const double> control, int channel_count,
                       std::span<Value> out) {
  const auto channels = static_cast<std::size_t>(channel_count);
  for_surface_tiles<Value>(values, control, channel_count, [&](std::size_t t, const auto& surface) {
    values.for_pixels(t, [&](std::size_t pixel, std::size_t place) {
      for (std::size_t c = 0; c < channels; ++c) out[pixel * channels + c] = surface[c * kPixels + place];
    });
  });
}

template void surface_at_pixels(const PixelValues&, std::span<const double>, int, std::span<double>);
template void surface_at_pixels(const PixelValues&, std::span<const double>, int, std::span<float>);

}  // namespace knotreel::spline
