#include "raster/tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/multiversion.h"

namespace knotreel::raster {

namespace {

constexpr Vec2 kDirection = {0.8191520442889918, 0.5735764363510462};
// Parameters stay this far, in pixels, off the right and lower side, so that kDirection points inside
// everywhere.
constexpr double kInset = 1e-7;
constexpr int kMaxSteps = 10;
// Newton's method is stopped after a step this small, in pixels. Where the map is C1 the error left is about
// the square of the step; next to its kink at a feature it may be a fraction of it.
constexpr double kSmallStep = 2e-3;
constexpr double kSmallStepAtFeature = 2e-4;

/// Zeroes v outside the walls of a tent, and where it is negative.
inline void cut_off(const spline::Tent& tent, const double* __restrict ux, const double* __restrict uy, int n,
                    double* __restrict v) {
  for (int k = 0; k < tent.wall_count; ++k) {
    const spline::Affine a = tent.walls[static_cast<std::size_t>(k)];
    // Points on the wall (within kOnWall) are inside if the direction points inside.
    const double least = a.nx * kDirection.x + a.ny * kDirection.y > 0 ? -spline::kOnWall : spline::kOnWall;
    for (int i = 0; i < n; ++i) {
      const double d = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
      v[i] = d >= least ? v[i] : 0;
    }
  }
  for (int i = 0; i < n; ++i) v[i] = v[i] > 0 ? v[i] : 0;
}

/// Tent times factor of a term at n points.
KNOTREEL_MULTIVERSION
void tent_values(const SurfaceTerm& term, const double* __restrict ux, const double* __restrict uy, int n,
                 double* __restrict v) {
  const spline::Tent& tent = term.tent;
  for (int i = 0; i < n; ++i)
    v[i] = tent.slope_count == 0 ? tent.constant : std::numeric_limits<double>::max();
  for (int s = 0; s < tent.slope_count; ++s) {
    const spline::Affine a = tent.slopes[static_cast<std::size_t>(s)];
    for (int i = 0; i < n; ++i) {
      const double w = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
      v[i] = w < v[i] ? w : v[i];
    }
  }
  cut_off(tent, ux, uy, n, v);
  if (!term.has_factor) return;
  const spline::Affine f = term.factor;
  for (int i = 0; i < n; ++i) v[i] *= f.nx * (ux[i] - f.px) + f.ny * (uy[i] - f.py);
}

/// The same with the gradient.
KNOTREEL_MULTIVERSION
void tent_gradients(const SurfaceTerm& term, const double* __restrict ux, const double* __restrict uy, int n,
                    double* __restrict v, double* __restrict gx, double* __restrict gy) {
  const spline::Tent& tent = term.tent;
  for (int i = 0; i < n; ++i)
    v[i] = tent.slope_count == 0 ? tent.constant : std::numeric_limits<double>::max();
  for (int i = 0; i < n; ++i) gx[i] = 0;
  for (int i = 0; i < n; ++i) gy[i] = 0;
  for (int s = 0; s < tent.slope_count; ++s) {
    const spline::Affine a = tent.slopes[static_cast<std::size_t>(s)];
    for (int i = 0; i < n; ++i) {
      const double w = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
      const bool lower = w < v[i];
      gx[i] = lower ? a.nx : gx[i];
      gy[i] = lower ? a.ny : gy[i];
      v[i] = lower ? w : v[i];
    }
  }
  cut_off(tent, ux, uy, n, v);
  for (int i = 0; i < n; ++i) gx[i] = v[i] > 0 ? gx[i] : 0;
  for (int i = 0; i < n; ++i) gy[i] = v[i] > 0 ? gy[i] : 0;
  if (!term.has_factor) return;
  const spline::Affine f = term.factor;
  for (int i = 0; i < n; ++i) {
    const double w = f.nx * (ux[i] - f.px) + f.ny * (uy[i] - f.py);
    gx[i] = gx[i] * w + v[i] * f.nx;
    gy[i] = gy[i] * w + v[i] * f.ny;
    v[i] *= w;
  }
}

/// Displacement and Jacobian of it at n points.
struct Geometry {
  alignas(64) std::array<double, kBatch> d[2];
  alignas(64) std::array<double, kBatch> j[2][2];
};

KNOTREEL_MULTIVERSION
void add_geometry(const SurfaceTerm& term, const double* __restrict ux, const double* __restrict uy, int n,
                  const double* __restrict v, const double* __restrict gx, const double* __restrict gy,
                  Geometry& g) {
  for (std::size_t c = 0; c < 2; ++c) {
    const Plane p = term.planes[c];
    const Vec2 o = term.origin;
    double* __restrict d = g.d[c].data();
    double* __restrict jx = g.j[c][0].data();
    double* __restrict jy = g.j[c][1].data();
    for (int i = 0; i < n; ++i) {
      const double w = p.value + p.gx * (ux[i] - o.x) + p.gy * (uy[i] - o.y);
      d[i] += v[i] * w;
      jx[i] += gx[i] * w + v[i] * p.gx;
      jy[i] += gy[i] * w + v[i] * p.gy;
    }
  }
}

KNOTREEL_MULTIVERSION
void add_colours(const SurfaceTerm& term, std::size_t channels, const double* __restrict ux,
                 const double* __restrict uy, int n, const double* __restrict v, double* __restrict out) {
  for (std::size_t c = kGeometryChannels; c < channels; ++c) {
    const Plane p = term.planes[c];
    const Vec2 o = term.origin;
    double* to = out + (c - kGeometryChannels) * kBatch;
    for (int i = 0; i < n; ++i) to[i] += v[i] * (p.value + p.gx * (ux[i] - o.x) + p.gy * (uy[i] - o.y));
  }
}

KNOTREEL_MULTIVERSION
void smooth_values(const Quadratic& q, Vec2 o, const double* __restrict ux, const double* __restrict uy,
                   int n, double* __restrict value) {
  for (int i = 0; i < n; ++i) {
    const double dx = ux[i] - o.x;
    const double dy = uy[i] - o.y;
    value[i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
  }
}

KNOTREEL_MULTIVERSION
void smooth_gradients(const Quadratic& q, Vec2 o, const double* __restrict ux, const double* __restrict uy,
                      int n, double* __restrict value, double* __restrict gx, double* __restrict gy) {
  for (int i = 0; i < n; ++i) {
    const double dx = ux[i] - o.x;
    const double dy = uy[i] - o.y;
    value[i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
    gx[i] = q.x + 2 * q.xx * dx + q.xy * dy;
    gy[i] = q.y + q.xy * dx + 2 * q.yy * dy;
  }
}

/// Quadratic interpolation of nine values on the square [0,2]^2 at n points, whose places are scaled to it.
KNOTREEL_MULTIVERSION
void interpolate(const std::array<double, 9>& node, Vec2 low, Vec2 size, const double* __restrict x,
                 const double* __restrict y, int n, double* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const double s = 2 * (x[i] - low.x) / size.x;
    const double t = 2 * (y[i] - low.y) / size.y;
    const double s0 = 0.5 * (s - 1) * (s - 2);
    const double s1 = s * (2 - s);
    const double s2 = 0.5 * s * (s - 1);
    const double r0 = s0 * node[0] + s1 * node[1] + s2 * node[2];
    const double r1 = s0 * node[3] + s1 * node[4] + s2 * node[5];
    const double r2 = s0 * node[6] + s1 * node[7] + s2 * node[8];
    out[i] = 0.5 * (t - 1) * (t - 2) * r0 + t * (2 - t) * r1 + 0.5 * t * (t - 1) * r2;
  }
}

/// One Newton step for n points, clamped to the box, with the length of each in `moved`; returns the longest.
KNOTREEL_MULTIVERSION
double newton_step(const Geometry& g, const double* __restrict x, const double* __restrict y, int n, Vec2 low,
                   Vec2 high, double* __restrict ux, double* __restrict uy, double* __restrict moved) {
  for (int i = 0; i < n; ++i) {
    const double rx = x[i] - ux[i] - g.d[0][static_cast<std::size_t>(i)];
    const double ry = y[i] - uy[i] - g.d[1][static_cast<std::size_t>(i)];
    const double a = 1 + g.j[0][0][static_cast<std::size_t>(i)];
    const double b = g.j[0][1][static_cast<std::size_t>(i)];
    const double c = g.j[1][0][static_cast<std::size_t>(i)];
    const double e = 1 + g.j[1][1][static_cast<std::size_t>(i)];
    double det = a * e - b * c;
    // A folded or nearly singular map: step as if it were the identity.
    const bool bad = !(det > 0.05);
    det = bad ? 1 : det;
    const double sx = bad ? rx : (e * rx - b * ry) / det;
    const double sy = bad ? ry : (a * ry - c * rx) / det;
    double px = ux[i] + sx;
    double py = uy[i] + sy;
    px = px < low.x ? low.x : px;
    px = px > high.x ? high.x : px;
    py = py < low.y ? low.y : py;
    py = py > high.y ? high.y : py;
    moved[i] = std::abs(px - ux[i]) + std::abs(py - uy[i]);
    ux[i] = px;
    uy[i] = py;
  }
  return *std::max_element(moved, moved + n);
}

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
    active = tent.slopes[0];
    value = active(centre_);
    for (int s = 1; s < tent.slope_count; ++s) {
      const spline::Affine& slope = tent.slopes[static_cast<std::size_t>(s)];
      if (slope(centre_) < value) {
        active = slope;
        value = active(centre_);
      }
    }
    for (int s = 0; s < tent.slope_count; ++s) {
      const spline::Affine& slope = tent.slopes[static_cast<std::size_t>(s)];
      if (slope(centre_) + spread(slope.nx, slope.ny) <= 0) return true;
      if (slope(centre_) - value < spread(slope.nx - active.nx, slope.ny - active.ny)) return false;
    }
    if (value < spread(active.nx, active.ny)) return false;
  }
  for (std::size_t c = 0; c < surface_.channels(); ++c) {
    const Plane& p = term.planes[c];
    const Vec2 d = centre_ - term.origin;
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

void Tile::assemble(const Box& box) {
  box_ = box;
  centre_ = 0.5 * (box.low + box.high);
  smooth_ = {};
  terms_.clear();
  has_kink_ = false;
  for (const SurfaceTerm* term : all_) {
    if (fold(*term)) continue;
    terms_.push_back(term);
    has_kink_ = has_kink_ || term->tent.wall_count > 0;
  }
}

void Tile::set(Vec2 low, Vec2 high, bool dense) {
  const Surface::Bounds bounds = surface_.displacement_bounds(low, high);
  const Vec2 limit{surface_.width() - kInset, surface_.height() - kInset};
  const auto clamped = [&](Vec2 u) {
    return Vec2{std::clamp(u.x, 0.0, limit.x), std::clamp(u.y, 0.0, limit.y)};
  };
  reach_ = {clamped(low - bounds.high), clamped(high - bounds.low)};
  shift_ = -0.5 * (bounds.low + bounds.high);
  identity_ = bounds.zero();
  has_nodes_ = false;
  entries_.clear();
  all_.clear();
  surface_.terms_in_box(reach_.low, reach_.high, entries_);
  for (const spline::TermIndex::Entry& e : entries_) all_.push_back(&surface_.terms()[e.term]);
  assemble(reach_);
  if (dense && !identity_) solve_nodes(low, high);
}

void Tile::solve_nodes(Vec2 low, Vec2 high) {
  std::array<double, 9> x;
  std::array<double, 9> y;
  for (std::size_t i = 0; i < 9; ++i) {
    x[i] = low.x + 0.5 * static_cast<double>(i % 3) * (high.x - low.x);
    y[i] = low.y + 0.5 * static_cast<double>(i / 3) * (high.y - low.y);
  }
  invert(x.data(), y.data(), 9);
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

/// Fills ux_, uy_. @return false if box_ was too small for some point.
bool Tile::invert(const double* x, const double* y, int n) {
  start_points(x, y, n);
  if (identity_) return true;
  alignas(64) std::array<double, kBatch> v;
  alignas(64) std::array<double, kBatch> gx;
  alignas(64) std::array<double, kBatch> gy;
  Geometry g;
  const double small = has_kink_ ? kSmallStepAtFeature : kSmallStep;
  double longest = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    for (std::size_t c = 0; c < 2; ++c) {
      smooth_gradients(smooth_[c], centre_, ux_.data(), uy_.data(), n, g.d[c].data(), g.j[c][0].data(),
                       g.j[c][1].data());
    }
    for (const SurfaceTerm* term : terms_) {
      tent_gradients(*term, ux_.data(), uy_.data(), n, v.data(), gx.data(), gy.data());
      add_geometry(*term, ux_.data(), uy_.data(), n, v.data(), gx.data(), gy.data(), g);
    }
    longest = newton_step(g, x, y, n, box_.low, box_.high, ux_.data(), uy_.data(), v.data());
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
    if (v[i] < small) continue;
    const Vec2 u = solve_point(surface_, {x[i], y[i]});
    ux_[i] = std::clamp(u.x, reach_.low.x, reach_.high.x);
    uy_[i] = std::clamp(u.y, reach_.low.y, reach_.high.y);
    if (ux_[i] < box_.low.x || ux_[i] > box_.high.x || uy_[i] < box_.low.y || uy_[i] > box_.high.y)
      return false;
  }
  return true;
}

void Tile::colours(const double* x, const double* y, int n, double* out) {
  const Box box = box_;
  const bool fits = invert(x, y, n);
  if (!fits) {
    assemble(reach_);
    invert(x, y, n);
  }
  alignas(64) std::array<double, kBatch> v;
  for (std::size_t c = kGeometryChannels; c < surface_.channels(); ++c) {
    smooth_values(smooth_[c], centre_, ux_.data(), uy_.data(), n, out + (c - kGeometryChannels) * kBatch);
  }
  for (const SurfaceTerm* term : terms_) {
    tent_values(*term, ux_.data(), uy_.data(), n, v.data());
    add_colours(*term, surface_.channels(), ux_.data(), uy_.data(), n, v.data(), out);
  }
  // What comes next must not depend on these points: a crop or a band may leave them out.
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
  Vec2 best = clamped(x);
  double best_residual = std::numeric_limits<double>::infinity();
  for (const Vec2 start : starts) {
    Vec2 u = clamped(start);
    Surface::Sample s = surface.evaluate(u);
    double residual = norm(u + s.displacement - x);
    for (int step = 0; step < 40 && residual > 1e-9; ++step) {
      const double a = 1 + s.jacobian[0][0];
      const double e = 1 + s.jacobian[1][1];
      const double det = a * e - s.jacobian[0][1] * s.jacobian[1][0];
      const Vec2 r = x - u - s.displacement;
      Vec2 move = r;
      if (det > 0.05) {
        move = {(e * r.x - s.jacobian[0][1] * r.y) / det, (a * r.y - s.jacobian[1][0] * r.x) / det};
      }
      // Halve the step until the residual falls.
      bool better = false;
      for (double t = 1; t > 1e-3 && !better; t *= 0.5) {
        const Vec2 next = clamped(u + t * move);
        const Surface::Sample sample = surface.evaluate(next);
        const double at_next = norm(next + sample.displacement - x);
        if (at_next < residual) {
          u = next;
          s = sample;
          residual = at_next;
          better = true;
        }
      }
      if (!better) break;
    }
    if (residual < best_residual) {
      best_residual = residual;
      best = u;
    }
    if (best_residual <= 1e-9) break;
  }
  return best;
}

}  // namespace knotreel::raster
