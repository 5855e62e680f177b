// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "knotreel/spline/basis.h"

namespace knotreel::spline {

namespace {

// Support boxes are widened by this much, in pixels, so that points on a wall find the terms of both sides.
constexpr double kMargin = 2 * kOnWall;

// Ordinary meshes have a few entries per term. Long slivers have as many as there are cells, which is
// quadratic in a fan of them; what is evaluated does not depend on the cells, so there they are made larger.
constexpr double kMostEntriesPerTerm = 64;

/// The nearest of so many cells: the first one if `v` is no number.
std::size_t cell_at(double v, std::size_t cells) {
  return static_cast<std::size_t>(std::min(std::max(0.0, v), static_cast<double>(cells - 1)));
}

}  // namespace

TermIndex::TermIndex(const PieceSet& set, double width, double height, std::size_t knots) {
  // About one knot per cell; never more cells than a few per knot, whatever the shape of the domain.
  set_cell(std::max(std::sqrt(width * height / static_cast<double>(knots)),
                    std::max(width, height) / (4.0 * static_cast<double>(knots))),
           width, height);

  boxes_.reserve(set.terms.size());
  std::vector<Entry> by_term;
  by_term.reserve(set.terms.size());
  for (std::uint32_t p = 0; p < set.pieces.size(); ++p) {
    for (std::uint32_t t = set.pieces[p].term_begin; t < set.pieces[p].term_end; ++t) {
      const Vec2 margin{kMargin, kMargin};
      boxes_.emplace_back(set.terms[t].low - margin, set.terms[t].high + margin);
      by_term.push_back({t, p});
    }
  }
  while (entries_needed() > kMostEntriesPerTerm * static_cast<double>(by_term.size()) && columns_ * rows_ > 1)
    set_cell(2 * cell_, width, height);
  const auto for_cells = [&](const Entry& e, auto&& visit) {
    const auto& [low, high] = boxes_[e.term];
    for (std::size_t r = row(low.y); r <= row(high.y); ++r) {
      for (std::size_t c = column(low.x); c <= column(high.x); ++c) visit(r * columns_ + c);
    }
  };
  begin_.assign(columns_ * rows_ + 1, 0);
  for (const Entry& e : by_term) for_cells(e, [&](std::size_t cell) { ++begin_[cell + 1]; });
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c) begin_[c + 1] += begin_[c];
  entries_.resize(begin_.back());
  std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
  for (const Entry& e : by_term) for_cells(e, [&](std::size_t cell) { entries_[cursor[cell]++] = e; });
}

void TermIndex::set_cell(double cell, double width, double height) {
  cell_ = cell;
  columns_ = static_cast<std::size_t>(width / cell_) + 1;
  rows_ = static_cast<std::size_t>(height / cell_) + 1;
}

double TermIndex::entries_needed() const {
  double sum = 0;
  for (const auto& [low, high] : boxes_) {
    sum += static_cast<double>(column(high.x) - column(low.x) + 1) *
           static_cast<double>(row(high.y) - row(low.y) + 1);
  }
  return sum;
}

std::size_t TermIndex::column(double x) const {
  return cell_at(x / cell_, columns_);
}

std::size_t TermIndex::row(double y) const {
  return cell_at(y / cell_, rows_);
}

std::span<const TermIndex::Entry> TermIndex::at(Vec2 u) const {
  const std::size_t cell = row(u.y) * columns_ + column(u.x);
  return std::span(entries_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
}

void TermIndex::in_box(Vec2 low, Vec2 high, std::vector<Entry>& out) const {
  const std::size_t before = out.size();
  for (std::size_t r = row(low.y); r <= row(high.y); ++r) {
    for (std::size_t c = column(low.x); c <= column(high.x); ++c) {
      for (std::size_t i = begin_[r * columns_ + c]; i < begin_[r * columns_ + c + 1]; ++i) {
        const auto& [a, b] = boxes_[entries_[i].term];
        if (a.x <= high.x && b.x >= low.x && a.y <= high.y && b.y >= low.y) out.push_back(entries_[i]);
      }
    }
  }
  const auto first = out.begin() + static_cast<std::ptrdiff_t>(before);
  std::sort(first, out.end(), [](const Entry& a, const Entry& b) { return a.term < b.term; });
  out.erase(std::unique(first, out.end(), [](const Entry& a, const Entry& b) { return a.term == b.term; }),
            out.end());
}

}  // namespace knotreel::spline
