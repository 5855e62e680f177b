// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/basis.h"

#include <algorithm>
#include <limits>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "spline/jet.h"

namespace knotreel::spline {

namespace {

void add(double& sum, double a) {
  sum += a;
}

double& payload(BasisValue& v) {
  return v.value;
}
Jet& payload(BasisJet& v) {
  return v.jet;
}

constexpr std::size_t kFew = 64;  ///< entries that are searched rather than sorted, which would need memory

template <class Entry>
bool before(const Entry& a, const Entry& b) {
  return a.function < b.function;
}

/// Sums entries of equal function from `begin` on, keeping the order of addition.
/// @return the end of the sums, which are in any order.
template <class Entry>
std::size_t sum_few(std::vector<Entry>& out, std::size_t begin) {
  std::size_t kept = begin;
  for (std::size_t i = begin; i < out.size(); ++i) {
    std::size_t k = begin;
    while (k < kept && out[k].function != out[i].function) ++k;
    if (k < kept) {
      add(payload(out[k]), payload(out[i]));
    } else {
      out[kept++] = out[i];
    }
  }
  return kept;
}

/// The same for any number of entries, with the sums in order.
template <class Entry>
std::size_t sum_many(std::vector<Entry>& out, std::size_t begin) {
  std::stable_sort(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), before<Entry>);
  std::size_t kept = begin;
  for (std::size_t i = begin; i < out.size();) {
    Entry sum = out[i++];
    for (; i < out.size() && out[i].function == sum.function; ++i) add(payload(sum), payload(out[i]));
    out[kept++] = sum;
  }
  return kept;
}

/// Sums entries of equal function from `begin` on, keeping the order of addition, and sorts them by function.
template <class Entry>
void merge(std::vector<Entry>& out, std::size_t begin) {
  if (out.size() - begin > kFew) {
    out.resize(sum_many(out, begin));
    return;
  }
  out.resize(sum_few(out, begin));
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), before<Entry>);
}

void append_values(const PieceSet& set, const TermIndex& index, Vec2 u, Vec2 direction,
                   std::vector<BasisValue>& out) {
  for (const TermIndex::Entry& e : index.at(u)) {
    if (!index.near(e, u)) continue;
    const PieceTerm& term = set.terms[e.term];
    const double w = term_value(term, u, direction);
    if (w == 0) continue;
    const Piece& piece = set.pieces[e.piece];
    // Degree 1: u counts as inside the closed face, so a negative coordinate is the tolerance of a wall.
    const double lowest = term.tent.slope_count == 0 ? 0 : -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      if (piece.functions[i] == kNoFunction) continue;
      out.push_back({piece.functions[i], w * std::max(piece.weights[i](u), lowest)});
    }
  }
}

}  // namespace

Basis::Basis(std::shared_ptr<const SplineSpace> space)
    : space_(space ? std::move(space)
                   : throw Error(ErrorKind::kInvalidArgument, "there is no spline space to evaluate")),
      pieces_(make_pieces(*space_)) {}

const TermIndex& Basis::index() const {
  std::call_once(index_->made, [this] {
    const mesh::KnotMesh& mesh = space_->mesh();
    index_->index = TermIndex(pieces_, mesh.width, mesh.height, mesh.knots.size());
  });
  return index_->index;
}

void Basis::evaluate(Vec2 u, Vec2 direction, std::vector<BasisValue>& out) const {
  out.clear();
  append_values(pieces_, index(), u, direction, out);
  merge(out, 0);
}

void Basis::evaluate(Vec2 u, std::vector<BasisValue>& out) const {
  evaluate(u, inward_direction(u, space_->mesh().width, space_->mesh().height), out);
}

void Basis::evaluate(Vec2 u, Vec2 direction, std::vector<BasisJet>& out) const {
  out.clear();
  const TermIndex& index = this->index();
  for (const TermIndex::Entry& e : index.at(u)) {
    if (!index.near(e, u)) continue;
    const PieceTerm& term = pieces_.terms[e.term];
    const Jet w = term_jet(term, u, direction);
    if (w == Jet{}) continue;
    const Piece& piece = pieces_.pieces[e.piece];
    for (std::size_t i = 0; i < 3; ++i) {
      if (piece.functions[i] == kNoFunction) continue;
      out.push_back({piece.functions[i], multiply(w, affine_jet(piece.weights[i], u))});
    }
  }
  merge(out, 0);
}

ScatteredValues Basis::evaluate(std::span<const Vec2> points) const {
  // Blocks of points are evaluated on their own and joined in order.
  constexpr std::size_t kBlock = 1024;
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  std::vector<std::vector<BasisValue>> values(blocks);
  ScatteredValues result;
  result.begin.assign(points.size() + 1, 0);
  const TermIndex& index = this->index();
  parallel_for(blocks, [&](std::size_t b) {
    const std::size_t end = std::min(points.size(), (b + 1) * kBlock);
    for (std::size_t i = b * kBlock; i < end; ++i) {
      const std::size_t before = values[b].size();
      const Vec2 direction = inward_direction(points[i], space_->mesh().width, space_->mesh().height);
      append_values(pieces_, index, points[i], direction, values[b]);
      merge(values[b], before);
      result.begin[i + 1] = values[b].size() - before;
    }
  });
  for (std::size_t i = 0; i < points.size(); ++i) result.begin[i + 1] += result.begin[i];
  result.values.reserve(result.begin.back());
  for (const auto& block : values) result.values.insert(result.values.end(), block.begin(), block.end());
  return result;
}

}  // namespace knotreel::spline
