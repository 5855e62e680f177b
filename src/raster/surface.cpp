// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/surface.h"

#include <algorithm>
#include <utility>

#include "knotreel/base/parallel.h"
#include "spline/tent.h"

namespace knotreel::raster {

namespace {

using Bounds = Surface::Bounds;

Bounds joined(const Bounds& a, const Bounds& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

}  // namespace

Surface::Surface(const document::FrameModel& model)
    : Surface(model, std::make_shared<const spline::Basis>(model.space)) {}

Surface::Surface(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis)
    : width_(model.space->mesh().width),
      height_(model.space->mesh().height),
      channels_(kGeometryChannels + static_cast<std::size_t>(model.channels)),
      degree_(model.space->degree()),
      basis_(std::move(basis)) {
  const auto& set = basis_->pieces();
  terms_.resize(set.terms.size());

  cell_ = std::max({4.0, width_ / 512, height_ / 512});
  columns_ = static_cast<std::size_t>(width_ / cell_) + 1;
  rows_ = static_cast<std::size_t>(height_ / cell_) + 1;
  cells_.resize(columns_ * rows_);
  std::vector<Bounds> bounds(set.pieces.size());
  constexpr std::size_t kPieces = 256;
  parallel_for((set.pieces.size() + kPieces - 1) / kPieces, [&](std::size_t block) {
    for (std::size_t p = block * kPieces; p < std::min(set.pieces.size(), (block + 1) * kPieces); ++p)
      bounds[p] = add_piece(model, set.pieces[p]);
  });
  for (std::size_t p = 0; p < bounds.size(); ++p) {
    if (!bounds[p].zero()) bound_cells(set.pieces[p], bounds[p]);
  }
  if (!model.displacement.empty()) {
    overall_ = {model.displacement[0], model.displacement[0]};
    for (const Vec2 d : model.displacement) overall_ = joined(overall_, {d, d});
  }
}

/// Makes the terms of a piece. @return bounds of its displacement.
Bounds Surface::add_piece(const document::FrameModel& model, const spline::Piece& piece) {
  const auto geometry_of = model.space->geometry_of();
  const auto colours = static_cast<std::size_t>(model.channels);
  Bounds bounds{};
  for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
    const spline::PieceTerm& from = basis_->pieces().terms[t];
    SurfaceTerm& term = terms_[t];
    term.tent = from.tent;
    term.factor = from.factor;
    term.has_factor = from.has_factor;
    term.origin = {piece.weights[0].px, piece.weights[0].py};
    for (std::size_t v = 0; v < 3; ++v) {
      const spline::FunctionIndex f = piece.functions[v];
      if (f == spline::kNoFunction) continue;
      const spline::Affine& w = piece.weights[v];
      const double at_origin = w(term.origin);
      const auto add = [&](std::size_t channel, double c) {
        Plane& p = term.planes[channel];
        p.value += c * at_origin;
        p.gx += c * w.nx;
        p.gy += c * w.ny;
      };
      const Vec2 d = model.displacement[geometry_of[f]];
      term.moves = term.moves || d != Vec2{};
      add(0, d.x);
      add(1, d.y);
      for (std::size_t c = 0; c < colours; ++c) add(kGeometryChannels + c, model.colour[f * colours + c]);
      bounds = joined(bounds, {d, d});
    }
  }
  return bounds;
}

void Surface::bound_cells(const spline::Piece& piece, const Bounds& bounds) {
  const auto column = [&](double x) { return std::min(static_cast<std::size_t>(x / cell_), columns_ - 1); };
  const auto row = [&](double y) { return std::min(static_cast<std::size_t>(y / cell_), rows_ - 1); };
  for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
    const spline::PieceTerm& term = basis_->pieces().terms[t];
    for (std::size_t r = row(term.low.y); r <= row(term.high.y); ++r) {
      for (std::size_t c = column(term.low.x); c <= column(term.high.x); ++c) {
        Bounds& cell = cells_[r * columns_ + c];
        cell = joined(cell, bounds);
      }
    }
  }
}

Bounds Surface::cell_bounds(Vec2 low, Vec2 high) const {
  const auto index = [&](double v, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(v, 0.0) / cell_), count - 1);
  };
  Bounds bounds = cells_[index(low.y, rows_) * columns_ + index(low.x, columns_)];
  for (std::size_t r = index(low.y, rows_); r <= index(high.y, rows_); ++r) {
    for (std::size_t c = index(low.x, columns_); c <= index(high.x, columns_); ++c) {
      bounds = joined(bounds, cells_[r * columns_ + c]);
    }
  }
  return bounds;
}

Bounds Surface::displacement_bounds(Vec2 low, Vec2 high) const {
  // u lies in the box minus the displacement; tighten that twice.
  Bounds bounds = overall_;
  for (int i = 0; i < 2 && !bounds.zero(); ++i) {
    bounds = cell_bounds(low - bounds.high, high - bounds.low);
  }
  return bounds;
}

Surface::Sample Surface::evaluate(Vec2 u) const {
  const Vec2 direction = spline::inward_direction(u, width_, height_);
  Sample s{};
  const spline::TermIndex& index = basis_->index();
  for (const spline::TermIndex::Entry& e : index.at(u)) {
    if (!index.near(e, u)) continue;
    const SurfaceTerm& term = terms_[e.term];
    spline::Jet w = spline::tent_jet(term.tent, u, direction);
    if (w.value == 0 && w.dx == 0 && w.dy == 0) continue;
    if (term.has_factor) {
      const double f = term.factor(u);
      w = {w.value * f, w.dx * f + w.value * term.factor.nx, w.dy * f + w.value * term.factor.ny, 0, 0, 0};
    }
    const Vec2 d = u - term.origin;
    std::array<double, kMaxChannels> value{};
    for (std::size_t c = 0; c < channels_; ++c) {
      const Plane& p = term.planes[c];
      value[c] = p.value + p.gx * d.x + p.gy * d.y;
    }
    s.displacement = s.displacement + Vec2{w.value * value[0], w.value * value[1]};
    for (std::size_t c = 0; c < 2; ++c) {
      s.jacobian[c][0] += w.dx * value[c] + w.value * term.planes[c].gx;
      s.jacobian[c][1] += w.dy * value[c] + w.value * term.planes[c].gy;
    }
    for (std::size_t c = kGeometryChannels; c < channels_; ++c) {
      s.colour[c - kGeometryChannels] += w.value * value[c];
    }
  }
  return s;
}

}  // namespace knotreel::raster
