// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/paint.h"

#include <algorithm>
#include <cmath>

namespace knotreel::exporting {

namespace {

// Regions that are next to a line have no gradient across it that could be told. In squares of pixels.
constexpr double kLeastSpread = 1e-4;
// Below, quotients by an area say nothing or are no numbers.
constexpr double kLeastArea = 1e-12;

}  // namespace

Moments& Moments::operator+=(const Moments& other) {
  area += other.area;
  x = x + other.x;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] += other.colour[c];
    x_colour[c] = x_colour[c] + other.x_colour[c];
  }
  squares += other.squares;
  return *this;
}

Moments moments_of(const std::array<Vec2, 3>& x, const std::array<Rgb, 3>& colour) {
  Moments m;
  m.area = 0.5 * std::abs(cross(x[1] - x[0], x[2] - x[0]));
  // The integral of a product of two linear functions: area / 12 (sum p_i q_i + sum p_i sum q_i).
  const double w = m.area / 12;
  const Vec2 sum = x[0] + x[1] + x[2];
  m.x = (m.area / 3) * sum;
  m.xx = w * (x[0].x * x[0].x + x[1].x * x[1].x + x[2].x * x[2].x + sum.x * sum.x);
  m.xy = w * (x[0].x * x[0].y + x[1].x * x[1].y + x[2].x * x[2].y + sum.x * sum.y);
  m.yy = w * (x[0].y * x[0].y + x[1].y * x[1].y + x[2].y * x[2].y + sum.y * sum.y);
  for (std::size_t c = 0; c < 3; ++c) {
    const double total = colour[0][c] + colour[1][c] + colour[2][c];
    m.colour[c] = m.area / 3 * total;
    m.x_colour[c] = w * (colour[0][c] * x[0] + colour[1][c] * x[1] + colour[2][c] * x[2] + total * sum);
    m.squares += w * (colour[0][c] * colour[0][c] + colour[1][c] * colour[1][c] +
                      colour[2][c] * colour[2][c] + total * total);
  }
  return m;
}

PaintFit fit_paint(const Moments& m) {
  PaintFit fit;
  if (!(m.area > kLeastArea)) return fit;
  Paint& paint = fit.paint;
  paint.centre = (1 / m.area) * m.x;
  // Covariances, of positions and of positions with colours. Far from the origin rounding may leave less than
  // nothing of them.
  const double xx = std::max(0.0, m.xx / m.area - paint.centre.x * paint.centre.x) + kLeastSpread;
  const double xy = m.xy / m.area - paint.centre.x * paint.centre.y;
  const double yy = std::max(0.0, m.yy / m.area - paint.centre.y * paint.centre.y) + kLeastSpread;
  double variance = m.squares / m.area;
  std::array<Vec2, 3> shared{};
  double bxx = 0, bxy = 0, byy = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    paint.colour[c] = m.colour[c] / m.area;
    variance -= paint.colour[c] * paint.colour[c];
    shared[c] = (1 / m.area) * m.x_colour[c] - paint.colour[c] * paint.centre;
    bxx += shared[c].x * shared[c].x;
    bxy += shared[c].x * shared[c].y;
    byy += shared[c].y * shared[c].y;
  }
  // A direction d explains sum (shared . d)^2 / d'Cd of the variance: the first eigenvector of C^-1 B.
  const double determinant = std::max(xx * yy - xy * xy, kLeastSpread * kLeastSpread);
  const double m00 = (yy * bxx - xy * bxy) / determinant;
  const double m01 = (yy * bxy - xy * byy) / determinant;
  const double m10 = (xx * bxy - xy * bxx) / determinant;
  const double m11 = (xx * byy - xy * bxy) / determinant;
  const double half = 0.5 * (m00 + m11);
  const double root = std::sqrt(std::max(0.0, half * half - (m00 * m11 - m01 * m10)));
  const double explained = half + root;
  const Vec2 first{m01, explained - m00};
  const Vec2 second{explained - m11, m10};
  const Vec2 d = norm(first) > norm(second) ? first : second;
  paint.direction = norm(d) > 0 ? unit(d) : Vec2{1, 0};
  const Vec2 e = paint.direction;
  const double spread = std::max(e.x * e.x * xx + 2 * e.x * e.y * xy + e.y * e.y * yy, kLeastSpread);
  for (std::size_t c = 0; c < 3; ++c) paint.slope[c] = dot(shared[c], e) / spread;
  fit.squared_error = m.area * std::max(0.0, variance - explained);
  return fit;
}

double root_mean_square(const Paint& paint, const Moments& m) {
  if (!(m.area > kLeastArea)) return 0;
  const Vec2 d = paint.direction;
  double sum = m.squares;
  for (std::size_t c = 0; c < 3; ++c) {
    // The paint as k + g . x
    const Vec2 g = paint.slope[c] * d;
    const double k = paint.colour[c] - dot(g, paint.centre);
    sum += k * k * m.area + 2 * k * dot(g, m.x) + g.x * g.x * m.xx + 2 * g.x * g.y * m.xy + g.y * g.y * m.yy;
    sum -= 2 * (k * m.colour[c] + dot(g, m.x_colour[c]));
  }
  return std::sqrt(std::max(0.0, sum / m.area));
}

}  // namespace knotreel::exporting
