// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/knot_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/multiversion.h"
#include "fit/shape_gradient.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using mesh::KnotIndex;
using mesh::KnotKind;
using spline::Affine;
using spline::Piece;
using spline::PieceTerm;

constexpr double kStep = 1e-5;  // pixels, for differences of coefficients
// Bands of tiles have sums of their own for the terms that they meet.
constexpr std::size_t kLeastRows = 4;  // of tiles
constexpr std::size_t kMostBands = 16;
constexpr std::size_t kPixelCount = spline::PixelValues::kTilePixels;

/// Two unit directions in which a knot may move; the second is unused for knots on a line.
struct Directions {
  int count = 0;
  std::array<Vec2, 2> d{};
};

/// None for knots that are not wanted.
std::vector<Directions> free_directions(const mesh::KnotMesh& mesh, std::span<const std::uint8_t> wanted) {
  std::vector<Directions> result(mesh.knots.size());
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    const mesh::Knot& knot = mesh.knots[k];
    if (knot.kind == KnotKind::kFree) result[k] = {2, {Vec2{1, 0}, Vec2{0, 1}}};
    if (knot.kind == KnotKind::kBorder) {
      const bool upright = knot.position.x == 0 || knot.position.x == mesh.width;
      result[k] = {1, {upright ? Vec2{0, 1} : Vec2{1, 0}, Vec2{}}};
    }
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 along = mesh.knots[s.knots.back()].position - mesh.knots[s.knots.front()].position;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      result[s.knots[i]] = {1, {unit(along), Vec2{}}};
    }
  }
  for (KnotIndex k = 0; k < wanted.size(); ++k) {
    if (!wanted[k]) result[k] = {};
  }
  return result;
}

/// Residual times weight of the pixels of a tile, channel by channel; none beside the picture.
struct TileResidual {
  std::array<std::array<float, kPixelCount>, 4> channels;
};

void read_residual(const Pixels& pixels, const ColourFit& fit, const spline::PixelValues& values,
                   std::size_t tile, TileResidual& out) {
  const auto channels = static_cast<std::size_t>(pixels.image->channels);
  for (std::size_t c = 0; c < channels; ++c) out.channels[c].fill(0);
  values.for_pixels(tile, [&](std::size_t pixel, std::size_t place) {
    const float weight = pixels.weights.empty() ? 1.0F : pixels.weights[pixel];
    for (std::size_t c = 0; c < channels; ++c)
      out.channels[c][place] = fit.residual[pixel * channels + c] * weight;
  });
}

/// q[i] = sum over channels of residual * control point, for the pixels of a tile.
KNOTREEL_MULTIVERSION
void project(const TileResidual& residual, const double* control, std::size_t channels, float* __restrict q) {
  for (std::size_t c = 0; c < channels; ++c) {
    const auto weight = static_cast<float>(control[c]);
    const std::array<float, kPixelCount>& r = residual.channels[c];
    for (std::size_t i = 0; i < kPixelCount; ++i) q[i] = c == 0 ? r[i] * weight : q[i] + r[i] * weight;
  }
}

/// Sums over the pixels of some rows of tiles, for the terms that they meet.
class Band {
 public:
  explicit Band(std::size_t pieces) : slots_(pieces, kNone) {}

  /// Those of the terms of a piece.
  std::span<ShapeGradient> of(std::size_t piece, std::size_t terms) {
    if (slots_[piece] == kNone) {
      slots_[piece] = static_cast<std::uint32_t>(sums_.size());
      sums_.resize(sums_.size() + terms);
    }
    return std::span(sums_).subspan(slots_[piece], terms);
  }

  /// Adds them to the sums over the whole picture.
  void add_to(const spline::PieceSet& set, std::span<ShapeGradient> by_term) const {
    for (std::size_t p = 0; p < slots_.size(); ++p) {
      if (slots_[p] == kNone) continue;
      const Piece& piece = set.pieces[p];
      for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t)
        fit::add_to(by_term[t], sums_[slots_[p] + t - piece.term_begin]);
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> slots_;
  std::vector<ShapeGradient> sums_;
};

class Derivatives {
 public:
  Derivatives(const spline::PixelValues& values, const Pixels& pixels, const ColourFit& fit,
              std::span<const std::uint8_t> wanted)
      : values_(values),
        basis_(values.basis()),
        pixels_(pixels),
        fit_(fit),
        directions_(free_directions(basis_.space().mesh(), wanted)) {
    movable_.reserve(basis_.space().configs().size());
    for (const spline::Config& c : basis_.space().configs()) movable_.push_back(has_movable_knot(c));
  }

  /// Adds the pixels of a tile to the gradients by the planes of all terms that have a movable knot.
  void add_tile(std::size_t tile, Band& band) const {
    const std::span<const std::uint32_t> pieces = values_.pieces(tile);
    if (std::none_of(pieces.begin(), pieces.end(), [&](std::uint32_t p) { return movable_[p]; })) return;
    const std::span<const spline::FunctionIndex> functions = values_.functions(tile);
    const float* const x = values_.places(tile).data();
    TileResidual residual;
    read_residual(pixels_, fit_, values_, tile, residual);
    const auto channels = static_cast<std::size_t>(pixels_.image->channels);
    thread_local std::vector<float> products;  // residual times control point of each function
    products.resize((functions.size() + 1) * kPixelCount);
    for (std::size_t f = 0; f < functions.size(); ++f)
      project(residual, &fit_.control[functions[f] * channels], channels, &products[f * kPixelCount]);
    const float* const zeros = &products[functions.size() * kPixelCount];
    std::fill_n(&products[functions.size() * kPixelCount], kPixelCount, 0.0F);
    const Vec2 corner = values_.corner(tile);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!movable_[pieces[i]]) continue;
      const Piece& piece = basis_.pieces().pieces[pieces[i]];
      const std::span<const PieceTerm> terms = terms_of(piece);
      const float* q[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t slot = values_.slots(tile)[i][k];
        q[k] = slot == spline::PixelValues::kNoSlot ? zeros : &products[slot * kPixelCount];
      }
      const std::span<ShapeGradient> sums = band.of(pieces[i], terms.size());
      const Vec2 offset = corner - origin_of(pieces[i]);
      for (std::size_t t = 0; t < terms.size(); ++t)
        add_pixels(shape_of(piece, terms[t], corner), x, x + kPixelCount, q, offset, sums[t]);
    }
  }

  struct Share {
    KnotIndex knot;
    Vec2 value;
  };

  /// d/dt of sum over pixels of r . S_config for the movable knots of one config. What an affine map of all
  /// knots brings is known from the planes, which it maps too. So only knots beyond the first three are
  /// shifted on their own: the map that moves one of the three, and not the others, takes those along.
  void add_shares(std::size_t config, std::span<const ShapeGradient> by_term, std::vector<Share>& out) const {
    const Piece& piece = basis_.pieces().pieces[config];
    if (piece.term_begin == piece.term_end || !movable_[config]) return;
    const std::span<const PieceTerm> terms = terms_of(piece);
    const auto gradients = by_term.subspan(piece.term_begin, terms.size());
    const Vec2 origin = origin_of(config);
    thread_local std::vector<Shape> shapes;
    shapes.clear();
    for (const PieceTerm& term : terms) shapes.push_back(shape_of(piece, term, origin));

    const Knots knots = knots_of(config);
    if (knots.count == 0) return;
    std::array<Vec2, 5> changes{};
    for (std::size_t i = 3; i < knots.count; ++i) {
      const std::optional<Vec2> change = by_shifts(config, knots.index[i], shapes, gradients);
      if (!change) return;  // as good as degenerate
      changes[i] = *change;
    }
    std::array<Vec2, 3> affine{};
    for (std::size_t t = 0; t < shapes.size(); ++t) add_affine(shapes[t], gradients[t], affine);
    const std::array<Vec2, 5>& p = knots.position;
    for (std::size_t v = 0; v < 3; ++v) {
      const Vec2 from = p[(v + 1) % 3];
      const Vec2 side = p[(v + 2) % 3] - from;
      const double area = cross(side, p[v] - from);
      // How far a point moves along: by its distance from the opposite side.
      const auto moved = [&](Vec2 u) { return cross(side, u - from) / area; };
      changes[v] = moved(origin) * affine[0] + (-side.y / area) * affine[1] + (side.x / area) * affine[2];
      for (std::size_t i = 3; i < knots.count; ++i) changes[v] = changes[v] - moved(p[i]) * changes[i];
    }
    for (std::size_t i = 0; i < knots.count; ++i) add_share(knots.index[i], changes[i], out);
  }

 private:
  Vec2 origin_of(std::size_t config) const {
    return basis_.space().position(basis_.space().configs()[config].triangle[0]);
  }

  std::span<const PieceTerm> terms_of(const Piece& piece) const {
    return std::span(basis_.pieces().terms).subspan(piece.term_begin, piece.term_end - piece.term_begin);
  }

  KnotIndex knot_of(spline::CornerIndex corner) const { return basis_.space().cut().corners[corner].knot; }

  bool has_movable_knot(const spline::Config& config) const {
    const auto movable = [&](spline::CornerIndex c) { return directions_[knot_of(c)].count > 0; };
    return std::any_of(config.triangle.begin(), config.triangle.end(), movable) ||
           std::any_of(config.inner.begin(), config.inner.begin() + basis_.space().degree() - 1, movable);
  }

  /// The knots of a config, each once, the three of the largest triangle first; none if that is flat.
  struct Knots {
    std::array<KnotIndex, 5> index{};
    std::array<Vec2, 5> position{};
    std::size_t count = 0;
  };

  Knots knots_of(std::size_t config) const {
    const spline::Config& c = basis_.space().configs()[config];
    Knots knots;
    const auto add = [&](spline::CornerIndex corner) {
      const KnotIndex k = knot_of(corner);
      const auto known = std::span(knots.index).first(knots.count);
      if (std::find(known.begin(), known.end(), k) != known.end()) return;
      knots.position[knots.count] = basis_.space().position(corner);
      knots.index[knots.count++] = k;
    };
    for (const auto corner : c.triangle) add(corner);
    for (int i = 0; i + 1 < basis_.space().degree(); ++i) add(c.inner[static_cast<std::size_t>(i)]);
    double largest = 0;
    std::array<std::size_t, 3> first{0, 1, 2};
    for (std::size_t i = 0; i < knots.count; ++i) {
      for (std::size_t j = i + 1; j < knots.count; ++j) {
        for (std::size_t k = j + 1; k < knots.count; ++k) {
          const double area = std::abs(signed_area(knots.position[i], knots.position[j], knots.position[k]));
          if (area <= largest) continue;
          largest = area;
          first = {i, j, k};
        }
      }
    }
    if (largest == 0) return {};
    // Ascending, so no swap undoes one before.
    for (std::size_t i = 0; i < 3; ++i) {
      std::swap(knots.index[i], knots.index[first[i]]);
      std::swap(knots.position[i], knots.position[first[i]]);
    }
    return knots;
  }

  /// The derivative by one knot, by small differences of the coefficients of the planes; none if the shape
  /// becomes another one.
  std::optional<Vec2> by_shifts(std::size_t config, KnotIndex knot, const std::vector<Shape>& shapes,
                                std::span<const ShapeGradient> gradients) const {
    const spline::SplineSpace& space = basis_.space();
    const Vec2 origin = origin_of(config);
    thread_local std::vector<PieceTerm> shifted;
    Vec2 result;
    for (const Vec2 direction : {Vec2{1, 0}, Vec2{0, 1}}) {
      shifted.clear();
      const Piece moved = spline::make_shifted_piece(
          space, config, {knot, space.mesh().knots[knot].position + kStep * direction}, shifted);
      if (shifted.size() != shapes.size()) return std::nullopt;
      double sum = 0;
      for (std::size_t t = 0; t < shapes.size(); ++t) {
        const Shape shape = shape_of(moved, shifted[t], origin);
        if (shape.slope_count != shapes[t].slope_count) return std::nullopt;
        sum += change(gradients[t], shapes[t], shape);
      }
      result = result + (sum / kStep) * direction;
    }
    return result;
  }

  /// Adds what the residual of one config brings for a knot, within the directions in which it may move.
  void add_share(KnotIndex knot, Vec2 change, std::vector<Share>& out) const {
    const Directions& free = directions_[knot];
    if (free.count == 0) return;
    out.push_back({knot, free.count == 2 ? change : dot(change, free.d[0]) * free.d[0]});
  }

  const spline::PixelValues& values_;
  const spline::Basis& basis_;
  const Pixels& pixels_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
  std::vector<std::uint8_t> movable_;  ///< by config: whether derivatives by some knot of it are taken
};

}  // namespace

std::vector<Vec2> knot_gradient(const spline::PixelValues& values, const Pixels& pixels, const ColourFit& fit,
                                std::span<const std::uint8_t> wanted) {
  const spline::Basis& basis = values.basis();
  if (!wanted.empty() && wanted.size() != basis.space().mesh().knots.size()) {
    throw Error(ErrorKind::kInvalidArgument, "a gradient is wanted for some of the knots, one flag per knot");
  }
  const Derivatives derivatives(values, pixels, fit, wanted);
  const std::size_t configs = basis.space().configs().size();
  const std::size_t columns = values.tile_columns();
  const std::size_t rows = values.tile_count() / columns;
  const std::size_t band_rows = std::max(kLeastRows, (rows + kMostBands - 1) / kMostBands);
  std::vector<Band> bands((rows + band_rows - 1) / band_rows, Band(configs));
  parallel_for(bands.size(), [&](std::size_t b) {
    for (std::size_t t = b * band_rows * columns; t < std::min(rows, (b + 1) * band_rows) * columns; ++t)
      derivatives.add_tile(t, bands[b]);
  });
  std::vector<ShapeGradient> by_term(basis.pieces().terms.size());
  for (const Band& band : bands) band.add_to(basis.pieces(), by_term);

  constexpr std::size_t kBlock = 128;
  std::vector<std::vector<Derivatives::Share>> shares((configs + kBlock - 1) / kBlock);
  parallel_for(shares.size(), [&](std::size_t b) {
    shares[b].reserve(4 * kBlock);
    for (std::size_t c = b * kBlock; c < std::min(configs, (b + 1) * kBlock); ++c)
      derivatives.add_shares(c, by_term, shares[b]);
  });
  std::vector<Vec2> gradient(basis.space().mesh().knots.size());
  for (const auto& block : shares) {
    for (const auto& s : block) gradient[s.knot] = gradient[s.knot] - 2 * s.value;
  }
  return gradient;
}

}  // namespace knotreel::fit
