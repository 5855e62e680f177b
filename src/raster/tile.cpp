#include "raster/tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/multiversion.h"

namespace knotreel::raster {

namespace {

constexpr Vec2 kDirection = {0.8191520442889918, 0.5735764363510462};
// Parameters stay this far, in pixels, off the right and lower side, so that kDirection points inside everywhere.
constexpr double kInset = 1e-7;
constexpr int kMaxSteps = 10;
// Newton's method is stopped after a step this small, in pixels: quadratic convergence leaves an error far below.
constexpr double kSmallStep = 1e-5;

/// Tent of a term at n points; the gradient too if gx is not null.
KNOTREEL_MULTIVERSION
void tents(const SurfaceTerm& term, const double* ux, const double* uy, int n, double* v, double* gx, double* gy) {
  const spline::Tent& tent = term.tent;
  if (tent.slope_count == 0) {
    for (int i = 0; i < n; ++i) v[i] = tent.constant;
    if (gx != nullptr) {
      for (int i = 0; i < n; ++i) gx[i] = gy[i] = 0;
    }
  }
  for (int s = 0; s < tent.slope_count; ++s) {
    const spline::Affine a = tent.slopes[static_cast<std::size_t>(s)];
    if (s == 0) {
      for (int i = 0; i < n; ++i) v[i] = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
      if (gx != nullptr) {
        for (int i = 0; i < n; ++i) gx[i] = a.nx;
        for (int i = 0; i < n; ++i) gy[i] = a.ny;
      }
    } else if (gx == nullptr) {
      for (int i = 0; i < n; ++i) {
        const double w = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
        v[i] = w < v[i] ? w : v[i];
      }
    } else {
      for (int i = 0; i < n; ++i) {
        const double w = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
        gx[i] = w < v[i] ? a.nx : gx[i];
        gy[i] = w < v[i] ? a.ny : gy[i];
        v[i] = w < v[i] ? w : v[i];
      }
    }
  }
  // Zero outside; walls first, since the value is what marks the outside for the gradient.
  for (int k = 0; k < tent.wall_count; ++k) {
    const spline::Affine a = tent.walls[static_cast<std::size_t>(k)];
    const double on = a.nx * kDirection.x + a.ny * kDirection.y > 0 ? -spline::kOnWall : spline::kOnWall;
    // on < 0: points on the wall (|d| <= kOnWall) are inside; else they are outside.
    for (int i = 0; i < n; ++i) {
      const double d = a.nx * (ux[i] - a.px) + a.ny * (uy[i] - a.py);
      const bool inside = on < 0 ? d >= on : d > on;
      v[i] = inside ? v[i] : 0;
    }
  }
  if (gx != nullptr) {
    for (int i = 0; i < n; ++i) gx[i] = v[i] > 0 ? gx[i] : 0;
    for (int i = 0; i < n; ++i) gy[i] = v[i] > 0 ? gy[i] : 0;
  }
  for (int i = 0; i < n; ++i) v[i] = v[i] > 0 ? v[i] : 0;
  if (term.has_factor) {
    const spline::Affine f = term.factor;
    for (int i = 0; i < n; ++i) {
      const double w = f.nx * (ux[i] - f.px) + f.ny * (uy[i] - f.py);
      if (gx != nullptr) {
        gx[i] = gx[i] * w + v[i] * f.nx;
        gy[i] = gy[i] * w + v[i] * f.ny;
      }
      v[i] *= w;
    }
  }
}

/// Displacement and Jacobian of it at n points.
struct Geometry {
  alignas(64) std::array<double, kBatch> d[2];
  alignas(64) std::array<double, kBatch> j[2][2];
};

KNOTREEL_MULTIVERSION
void add_geometry(const SurfaceTerm& term, const double* ux, const double* uy, int n, const double* v,
                  const double* gx, const double* gy, Geometry& g) {
  for (std::size_t c = 0; c < 2; ++c) {
    const Plane p = term.planes[c];
    const Vec2 o = term.origin;
    double* d = g.d[c].data();
    double* jx = g.j[c][0].data();
    double* jy = g.j[c][1].data();
    for (int i = 0; i < n; ++i) {
      const double w = p.value + p.gx * (ux[i] - o.x) + p.gy * (uy[i] - o.y);
      d[i] += v[i] * w;
      jx[i] += gx[i] * w + v[i] * p.gx;
      jy[i] += gy[i] * w + v[i] * p.gy;
    }
  }
}

KNOTREEL_MULTIVERSION
void add_colours(const SurfaceTerm& term, std::size_t channels, const double* ux, const double* uy, int n,
                 const double* v, double* out) {
  for (std::size_t c = kGeometryChannels; c < channels; ++c) {
    const Plane p = term.planes[c];
    const Vec2 o = term.origin;
    double* to = out + (c - kGeometryChannels) * kBatch;
    for (int i = 0; i < n; ++i) to[i] += v[i] * (p.value + p.gx * (ux[i] - o.x) + p.gy * (uy[i] - o.y));
  }
}

/// One Newton step for n points, clamped to the box, with the length of each in `moved`; returns the longest.
KNOTREEL_MULTIVERSION
double newton_step(const Geometry& g, const double* x, const double* y, int n, Vec2 low, Vec2 high, double* ux,
                   double* uy, double* moved) {
  double longest = 0;
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
    longest = moved[i] > longest ? moved[i] : longest;
    ux[i] = px;
    uy[i] = py;
  }
  return longest;
}

}  // namespace

bool Tile::fold(const SurfaceTerm& term) {
  if (surface_.degree() > 2 || term.has_factor) return false;
  const spline::Tent& tent = term.tent;
  const Vec2 half = 0.5 * (high_ - low_);
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

void Tile::set(Vec2 low, Vec2 high) {
  const Surface::Bounds bounds = surface_.displacement_bounds(low, high);
  identity_ = bounds.zero();
  const double right = surface_.width() - kInset;
  const double bottom = surface_.height() - kInset;
  low_ = {std::clamp(low.x - bounds.high.x, 0.0, right), std::clamp(low.y - bounds.high.y, 0.0, bottom)};
  high_ = {std::clamp(high.x - bounds.low.x, 0.0, right), std::clamp(high.y - bounds.low.y, 0.0, bottom)};
  centre_ = 0.5 * (low_ + high_);
  start_ = -0.5 * (bounds.low + bounds.high);  // displacement is image minus parameter
  smooth_ = {};
  terms_.clear();
  entries_.clear();
  surface_.terms_in_box(low_, high_, entries_);
  for (const spline::TermIndex::Entry& e : entries_) {
    const SurfaceTerm& term = surface_.terms()[e.term];
    if (!fold(term)) terms_.push_back(&term);
  }
}

void Tile::invert(const double* x, const double* y, int n) {
  alignas(64) std::array<double, kBatch> v;
  alignas(64) std::array<double, kBatch> gx;
  alignas(64) std::array<double, kBatch> gy;
  Geometry g;
  for (int i = 0; i < n; ++i) {
    ux_[static_cast<std::size_t>(i)] = std::clamp(x[i] + start_.x, low_.x, high_.x);
    uy_[static_cast<std::size_t>(i)] = std::clamp(y[i] + start_.y, low_.y, high_.y);
  }
  if (identity_) return;
  for (int step = 0; step < kMaxSteps; ++step) {
    for (std::size_t c = 0; c < 2; ++c) {
      const Quadratic q = smooth_[c];
      for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
        const double dx = ux_[i] - centre_.x;
        const double dy = uy_[i] - centre_.y;
        g.d[c][i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
        g.j[c][0][i] = q.x + 2 * q.xx * dx + q.xy * dy;
        g.j[c][1][i] = q.y + q.xy * dx + 2 * q.yy * dy;
      }
    }
    for (const SurfaceTerm* term : terms_) {
      tents(*term, ux_.data(), uy_.data(), n, v.data(), gx.data(), gy.data());
      add_geometry(*term, ux_.data(), uy_.data(), n, v.data(), gx.data(), gy.data(), g);
    }
    if (newton_step(g, x, y, n, low_, high_, ux_.data(), uy_.data(), v.data()) < kSmallStep) return;
  }
  // Rare: points that jump to and fro across the kink that the map has at a feature. Each on its own, with care.
  for (int i = 0; i < n; ++i) {
    if (v[static_cast<std::size_t>(i)] < kSmallStep) continue;
    const Vec2 u = solve_point(surface_, {x[i], y[i]});
    ux_[static_cast<std::size_t>(i)] = std::clamp(u.x, low_.x, high_.x);
    uy_[static_cast<std::size_t>(i)] = std::clamp(u.y, low_.y, high_.y);
  }
}

void Tile::colours(const double* x, const double* y, int n, double* out) {
  invert(x, y, n);
  alignas(64) std::array<double, kBatch> v;
  for (std::size_t c = kGeometryChannels; c < surface_.channels(); ++c) {
    const Quadratic q = smooth_[c];
    double* to = out + (c - kGeometryChannels) * kBatch;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      const double dx = ux_[i] - centre_.x;
      const double dy = uy_[i] - centre_.y;
      to[i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
    }
  }
  for (const SurfaceTerm* term : terms_) {
    tents(*term, ux_.data(), uy_.data(), n, v.data(), nullptr, nullptr);
    add_colours(*term, surface_.channels(), ux_.data(), uy_.data(), n, v.data(), out);
  }
}

Vec2 solve_point(const Surface& surface, Vec2 x) {
  const Vec2 limit{surface.width() - kInset, surface.height() - kInset};
  const auto clamped = [&](Vec2 u) { return Vec2{std::clamp(u.x, 0.0, limit.x), std::clamp(u.y, 0.0, limit.y)}; };
  const Surface::Bounds b = surface.displacement_bounds(x, x);
  const Vec2 starts[] = {x, x - 0.5 * (b.low + b.high), x - b.low, x - b.high,
                         {x.x - b.low.x, x.y - b.high.y}, {x.x - b.high.x, x.y - b.low.y}};
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
