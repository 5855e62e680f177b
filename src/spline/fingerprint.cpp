// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/fingerprint.h"

#include <array>
#include <bit>

#include "knotreel/base/parallel.h"

namespace knotreel::spline {

namespace {

constexpr std::size_t kPiecesAtOnce = 256;  // of one call of a parallel loop

std::uint64_t mixed(std::uint64_t v) {
  v = (v ^ (v >> 32)) * 0xd6e8feb86659fd93ULL;
  v = (v ^ (v >> 29)) * 0x9e3779b97f4a7c15ULL;
  return v ^ (v >> 32);
}

/// Of a sequence of numbers.
class Print {
 public:
  void add(std::uint64_t v) { state_ = std::rotl(state_ ^ v, 29) * 0x9e3779b97f4a7c15ULL; }
  void add(double v) { add(std::bit_cast<std::uint64_t>(v)); }
  void add(const Affine& a) {
    add(a.nx);
    add(a.ny);
    add(a.px);
    add(a.py);
  }
  void add(const PieceTerm& term) {
    const Tent& tent = term.tent;
    for (int i = 0; i < tent.slope_count; ++i) add(tent.slopes[static_cast<std::size_t>(i)]);
    for (int i = 0; i < tent.wall_count; ++i) add(tent.walls[static_cast<std::size_t>(i)]);
    add(static_cast<std::uint64_t>(tent.slope_count * 8 + tent.wall_count));
    if (tent.slope_count == 0) add(tent.constant);
    if (term.has_factor) add(term.factor);
  }
  std::uint64_t value() const { return mixed(state_); }

 private:
  std::uint64_t state_ = 0x243f6a8885a308d3ULL;
};

/// Of what a piece adds to each of its functions.
std::array<std::uint64_t, 3> prints_of(const PieceSet& set, const Piece& piece) {
  Print terms;
  for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) terms.add(set.terms[t]);
  std::array<std::uint64_t, 3> prints{};
  for (std::size_t k = 0; k < 3; ++k) {
    Print print = terms;
    print.add(piece.weights[k]);
    prints[k] = print.value();
  }
  return prints;
}

}  // namespace

std::vector<std::uint64_t> function_fingerprints(const Basis& basis) {
  const PieceSet& set = basis.pieces();
  std::vector<std::array<std::uint64_t, 3>> of_piece(set.pieces.size());
  parallel_for((of_piece.size() + kPiecesAtOnce - 1) / kPiecesAtOnce, [&](std::size_t block) {
    for (std::size_t p = block * kPiecesAtOnce; p < std::min(of_piece.size(), (block + 1) * kPiecesAtOnce);
         ++p)
      of_piece[p] = prints_of(set, set.pieces[p]);
  });
  // Sums do not depend on the order, which goes by the numbers of knots.
  std::vector<std::uint64_t> prints(basis.space().function_count(), 0);
  for (std::size_t p = 0; p < of_piece.size(); ++p) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (set.pieces[p].functions[k] != kNoFunction) prints[set.pieces[p].functions[k]] += of_piece[p][k];
    }
  }
  return prints;
}

}  // namespace knotreel::spline
