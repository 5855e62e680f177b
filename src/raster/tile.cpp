// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/damped_newton.h"

namespace knotreel::raster {

namespace {

// Parameters stay this far, in pixels, off the right and lower side, so that kDirection points inside
// everywhere.
constexpr double kInset = 1e-7;
constexpr int kMaxSteps = 10;
// Newton's method is stopped after a step this small, in pixels. Where the map is C1 the error left is about
// the square of the step; next to a kink, as at a feature, it may be a fraction of it.
constexpr double kSmallStep = 8e-3;
constexpr double kSmallStepAtKink = 1e-3;
// Nodes only give other points their start.
constexpr double kSmallStepOfNodes = 2e-2;

}  // namespace

bool Tile::fold(const SurfaceTerm& term) {
  if (surface_.degree() > 2 || term.has_factor) return false;
  const spline::Tent& tent = term.tent;
  const Vec2 half = 0.5 * (box_.high - box_.low);
  const auto spread = [&](double nx, double ny) { return std::abs(nx) * half.x + std::abs(ny) * half.y; };
  for (int k = 0; k < tent.wall_count; ++k) {
    const spline::Affine& wall = tent.walls[static_cast<std::size_t>(k)];
    const double d = wall(centre_);
    const double r = spread(wall.nx, wall.ny) + 2 * spline::kOnWall;
    if (d < -r) return true;  // zero in the whole box
    if (d < r) return false;
  }
  spline::Affine active{};
  double value = tent.constant;
  if (tent.slope_count > 0) {
    const auto slopes = std::span(tent.slopes).first(static_cast<std::size_t>(tent.slope_count));
    std::array<double, 4> at_centre;
    std::size_t least = 0;
    for (std::size_t s = 0; s < slopes.size(); ++s) {
      at_centre[s] = slopes[s](centre_);
      if (at_centre[s] < at_centre[least]) least = s;
    }
    active = slopes[least];
    value = at_centre[least];
    for (std::size_t s = 0; s < slopes.size(); ++s) {
      const spline::Affine& slope = slopes[s];
      if (at_centre[s] + spread(slope.nx, slope.ny) <= 0) return true;
      if (at_centre[s] - value < spread(slope.nx - active.nx, slope.ny - active.ny)) return false;
    }
    if (value < spread(active.nx, active.ny)) return false;
  }
  const Vec2 d = centre_ - term.origin;
  for (std::size_t c = identity_ ? kGeometryChannels : 0; c < surface_.channels(); ++c) {
    const Plane& p = term.planes[c];
    const double l = p.value + p.gx * d.x + p.gy * d.y;
    Quadratic& q = smooth_[c];
    q.c += value * l;
    q.x += value * p.gx + active.nx * l;
    q.y += value * p.gy + active.ny * l;
    q.xx += active.nx * p.gx;
    q.xy += active.nx * p.gy + active.ny * p.gx;
    q.yy += active.ny * p.gy;
  }
  return true;
}

/// Whether a term is zero in the whole box, and a little around it.
bool Tile::vanishes(const BoxedTerm& t, const Box& box) {
  if (!t.box.touches(box)) return true;
  const spline::Tent& tent = t.term->tent;
  const Vec2 centre = 0.5 * (box.low + box.high);
  const Vec2 half = 0.5 * (box.high - box.low) + Vec2{2 * spline::kOnWall, 2 * spline::kOnWall};
  // One bound that is not positive would do, but the least of all of them needs no branches, which could not
  // be foreseen here.
  double least = tent.slope_count > 0 ? std::numeric_limits<double>::infinity() : tent.constant;
  const auto add_bound = [&](const spline::Affine& a) {
    least = std::min(least, a(centre) + std::abs(a.nx) * half.x + std::abs(a.ny) * half.y);
  };
  std::for_each_n(tent.slopes.begin(), tent.slope_count, add_bound);
  std::for_each_n(tent.walls.begin(), tent.wall_count, add_bound);
  return least <= 0;
}

void Tile::assemble(const Box& box) {
  box_ = box;
  centre_ = 0.5 * (box.low + box.high);
  smooth_ = {};
  terms_.clear();
  has_kink_ = false;
  for (const BoxedTerm& t : all_) {
    if (fold(*t.term)) continue;
    has_kink_ = has_kink_ || t.term->tent.wall_count > 0;
    if (!vanishes(t, box_)) terms_.push_back(t);
  }
}

/// Contains the parameters of all image points in [low, high], where the displacement has these bounds.
Tile::Box Tile::reach_of(const Surface::Bounds& displacement, Vec2 low, Vec2 high) const {
  const Vec2 limit{surface_.width() - kInset, surface_.height() - kInset};
  const auto clamped = [&](Vec2 u) {
    return Vec2{std::clamp(u.x, 0.0, limit.x), std::clamp(u.y, 0.0, limit.y)};
  };
  return {clamped(low - displacement.high), clamped(high - displacement.low)};
}

void Tile::set_block(Vec2 low, Vec2 high) {
  const Box reach = reach_of(surface_.displacement_bounds(low, high), low, high);
  const spline::TermIndex& index = surface_.basis().index();
  entries_.clear();
  index.in_box(reach.low, reach.high, entries_);
  block_.clear();
  for (const spline::TermIndex::Entry& e : entries_) {
    const auto& [box_low, box_high] = index.box(e.term);
    block_.push_back({{box_low, box_high}, &surface_.terms()[e.term]});
  }
}

void Tile::set(Vec2 low, Vec2 high) {
  const Surface::Bounds bounds = surface_.displacement_bounds(low, high);
  reach_ = reach_of(bounds, low, high);
  shift_ = -0.5 * (bounds.low + bounds.high);
  identity_ = bounds.zero();
  has_nodes_ = false;
  all_.clear();
  for (const BoxedTerm& t : block_) {
    if (t.box.touches(reach_)) all_.push_back(t);
  }
  assemble(reach_);
  if (!identity_) solve_nodes(low, high);
}

void Tile::solve_nodes(Vec2 low, Vec2 high) {
  std::array<double, 9> x;
  std::array<double, 9> y;
  for (std::size_t i = 0; i < 9; ++i) {
    x[i] = low.x + 0.5 * static_cast<double>(i % 3) * (high.x - low.x);
    y[i] = low.y + 0.5 * static_cast<double>(i / 3) * (high.y - low.y);
  }
  invert(x.data(), y.data(), 9, kSmallStepOfNodes);
  std::copy_n(ux_.begin(), 9, node_u_[0].begin());
  std::copy_n(uy_.begin(), 9, node_u_[1].begin());
  node_low_ = low;
  node_size_ = high - low;
  has_nodes_ = true;
  const auto [x0, x1] = std::minmax_element(node_u_[0].begin(), node_u_[0].end());
  const auto [y0, y1] = std::minmax_element(node_u_[1].begin(), node_u_[1].end());
  // The image box is hardly bent: a tenth more holds all its parameters, or invert() notices.
  const double margin = 0.05 * std::max(*x1 - *x0, *y1 - *y0);
  assemble({{std::max(*x0 - margin, reach_.low.x), std::max(*y0 - margin, reach_.low.y)},
            {std::min(*x1 + margin, reach_.high.x), std::min(*y1 + margin, reach_.high.y)}});
}

/// First parameters for n points: between the nodes by quadratic interpolation, or a common shift.
void Tile::start_points(const double* x, const double* y, int n) {
  if (!has_nodes_) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      ux_[i] = x[i] + shift_.x;
      uy_[i] = y[i] + shift_.y;
    }
  } else {
    interpolate(node_u_[0], node_low_, node_size_, x, y, n, ux_.data());
    interpolate(node_u_[1], node_low_, node_size_, x, y, n, uy_.data());
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    ux_[i] = std::clamp(ux_[i], box_.low.x, box_.high.x);
    uy_[i] = std::clamp(uy_[i], box_.low.y, box_.high.y);
  }
}

/// The terms that may be non-zero at the first n parameters.
std::span<const Tile::BoxedTerm> Tile::terms_of_points(int n) {
  const auto [x0, x1] = std::minmax_element(ux_.begin(), ux_.begin() + n);
  const auto [y0, y1] = std::minmax_element(uy_.begin(), uy_.begin() + n);
  const Box points{{*x0, *y0}, {*x1, *y1}};
  // The pixels of the tile fill box_, and nearly all terms are met; the points of one pixel meet few.
  if (points.high.x - points.low.x > 0.5 * (box_.high.x - box_.low.x)) return terms_;
  near_.clear();
  for (const BoxedTerm& t : terms_) {
    if (!vanishes(t, points)) near_.push_back(t);
  }
  return near_;
}

/// Fills ux_, uy_ by Newton's method until the longest step is below `small` pixels.
/// @return false if box_ was too small for some point.
bool Tile::invert(const double* x, const double* y, int n, double small) {
  start_points(x, y, n);
  if (identity_) return true;
  alignas(64) std::array<double, kBatch> moved;
  GeometryBatch g;
  double longest = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    for (std::size_t c = 0; c < 2; ++c) {
      set_geometry(smooth_[c], centre_, ux_.data(), uy_.data(), n, g.d[c].data(), g.j[c][0].data(),
                   g.j[c][1].data());
    }
    for (const BoxedTerm& t : terms_of_points(n)) {
      if (t.term->moves) add_geometry(*t.term, ux_.data(), uy_.data(), n, g);
    }
    longest = newton_step(g, x, y, n, box_.low, box_.high, ux_.data(), uy_.data(), moved.data());
    if (longest < small) break;
  }
  // Points held back at an edge of the box that is no edge of what they may reach.
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    if ((ux_[i] <= box_.low.x && box_.low.x > reach_.low.x) ||
        (ux_[i] >= box_.high.x && box_.high.x < reach_.high.x) ||
        (uy_[i] <= box_.low.y && box_.low.y > reach_.low.y) ||
        (uy_[i] >= box_.high.y && box_.high.y < reach_.high.y)) {
      return false;
    }
  }
  if (longest < small) return true;
  // Rare: points that jump to and fro across the kink that the map has at a feature. Each on its own, with
  // care.
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    if (moved[i] < small) continue;
    const Vec2 u = solve_point(surface_, {x[i], y[i]});
    ux_[i] = std::clamp(u.x, reach_.low.x, reach_.high.x);
    uy_[i] = std::clamp(u.y, reach_.low.y, reach_.high.y);
    if (ux_[i] < box_.low.x || ux_[i] > box_.high.x || uy_[i] < box_.low.y || uy_[i] > box_.high.y)
      return false;
  }
  return true;
}

bool Tile::invert_or_reach(const double* x, const double* y, int n, double small) {
  if (invert(x, y, n, small)) return true;
  assemble(reach_);
  invert(x, y, n, kSmallStepAtKink);
  return false;
}

void Tile::colours(const double* x, const double* y, int n, double* out) {
  const Box box = box_;
  const bool fits = invert_or_reach(x, y, n, has_kink_ ? kSmallStepAtKink : kSmallStep);
  for (std::size_t c = kGeometryChannels; c < surface_.channels(); ++c) {
    set_colour(smooth_[c], centre_, ux_.data(), uy_.data(), n, out + (c - kGeometryChannels) * kBatch);
  }
  for (const BoxedTerm& t : terms_of_points(n)) {
    add_colours(*t.term, surface_.channels(), ux_.data(), uy_.data(), n, out);
  }
  // What comes next must not depend on these points: a crop or a band may leave them out.
  if (!fits) assemble(box);
}

void Tile::places(const double* x, const double* y, int n, Vec2* out) {
  const Box box = box_;
  const bool fits = invert_or_reach(x, y, n, kSmallStepAtKink);
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) out[i] = {ux_[i], uy_[i]};
  if (!fits) assemble(box);
}

Vec2 solve_point(const Surface& surface, Vec2 x) {
  const Vec2 limit{surface.width() - kInset, surface.height() - kInset};
  const auto clamped = [&](Vec2 u) {
    return Vec2{std::clamp(u.x, 0.0, limit.x), std::clamp(u.y, 0.0, limit.y)};
  };
  const Surface::Bounds b = surface.displacement_bounds(x, x);
  const Vec2 starts[] = {x,          x - 0.5 * (b.low + b.high),      x - b.low,
                         x - b.high, {x.x - b.low.x, x.y - b.high.y}, {x.x - b.high.x, x.y - b.low.y}};
  const auto map = [&](Vec2 u) {
    const Surface::Sample s = surface.evaluate(u);
    const auto& j = s.jacobian;
    return fit::MapValue{u + s.displacement, {1 + j[0][0], j[1][0]}, {j[0][1], 1 + j[1][1]}};
  };
  fit::Attempt best{clamped(x), std::numeric_limits<double>::infinity()};
  for (const Vec2 start : starts) {
    const fit::Attempt attempt = fit::damped_newton(x, start, {}, map, clamped);
    if (attempt.miss < best.miss) best = attempt;
    if (best.miss <= fit::DampedNewtonOptions{}.tolerance) break;
  }
  return best.place;
}

}  // namespace knotreel::raster
