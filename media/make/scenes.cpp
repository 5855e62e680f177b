// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "knotreel/base/parallel.h"

namespace knotreel::media {
namespace {

using Vec = Colour;

constexpr Vec kLight{-0.48, -0.60, 0.64};

double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec scaled(double s, const Vec& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
Vec mix(const Vec& a, const Vec& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}
double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Repeatable noise in [0,1]: a few waves in odd directions.
double ripple(double x, double y) {
  return 0.5 + 0.125 * (std::sin(1.9 * x + 0.7 * y + 1) + std::sin(-1.1 * x + 2.3 * y + 2) +
                        std::sin(3.7 * x - 1.9 * y) + std::sin(2.6 * x + 4.1 * y + 4));
}

struct Ball {
  double x, y, rx, ry;
  Vec colour;
};

std::array<Ball, 3> balls_at(const std::array<double, 3>& t) {
  const auto turn = [&](std::size_t ball) { return std::numbers::pi * t[ball]; };
  return {Ball{11.5 - 1.6 * t[0], 3.2 + 0.5 * std::sin(turn(0)), 1.9, 1.9, {0.20, 0.45, 0.85}},
          Ball{8.2 + 0.9 * std::cos(turn(1)), 5.9, 2.3, 1.4, {0.25, 0.70, 0.35}},
          Ball{2.6 + 2.7 * t[2], 6.2 - 2.6 * std::abs(std::sin(turn(2))), 1.5, 1.5, {0.92, 0.35, 0.22}}};
}

/// Bricks with a soft pattern on them.
Vec wall(double x, double y) {
  const double row = std::floor(y / 1.5);
  const double u = x / 3 + 0.5 * std::fmod(row + 10, 2);
  const double joint =
      std::min({std::abs(u - std::round(u)) * 3, std::abs(y - 1.5 * row), 1.5 * (row + 1) - y});
  const double tone =
      0.85 + 0.3 * (ripple(5.1 * std::floor(u), 3.3 * row) - 0.5) + 0.25 * (ripple(x, y) - 0.5);
  return joint < 0.06 ? Vec{0.52, 0.50, 0.46} : scaled(tone, {0.80, 0.66, 0.52});
}

Vec shaded(const Vec& colour, const Vec& normal) {
  const double lit = std::max(0.0, dot(normal, kLight));
  const double shine = std::pow(std::max(0.0, 2 * lit * normal[2] - kLight[2]), 24);
  return mix(scaled(0.25 + 0.75 * lit, colour), {1, 1, 1}, 0.6 * shine);
}

/// To the axes of the box, which turns about two of its own.
Vec turned(const Vec& p, double t) {
  const double a = 0.5 + 0.9 * t;
  const double b = 0.55;
  const double y = std::cos(b) * p[1] - std::sin(b) * p[2];
  const double z = std::sin(b) * p[1] + std::cos(b) * p[2];
  return {std::cos(a) * p[0] + std::sin(a) * z, y, -std::sin(a) * p[0] + std::cos(a) * z};
}

/// @return whether the box is hit; then `colour` is its own.
bool box(double x, double y, double t, Vec& colour) {
  const Vec size{1.9, 1.3, 1.6};
  const Vec from = turned({x - 8 - 0.5 * std::sin(t), y - 3.7, 10}, t);
  const Vec ray = turned({0, 0, -1}, t);
  const Vec light = turned(kLight, t);
  double near = -1e9, far = 1e9;
  std::size_t face = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = (-std::copysign(size[i], ray[i]) - from[i]) / ray[i];
    const double b = (std::copysign(size[i], ray[i]) - from[i]) / ray[i];
    if (a > near) face = i;
    near = std::max(near, a);
    far = std::min(far, b);
  }
  if (near >= far) return false;
  const std::array<Vec, 3> colours{Vec{0.90, 0.55, 0.15}, Vec{0.95, 0.85, 0.40}, Vec{0.75, 0.20, 0.30}};
  const double lit = std::max(0.0, -std::copysign(1.0, ray[face]) * light[face]);
  const double fade = 0.06 * (from[(face + 1) % 3] + near * ray[(face + 1) % 3]);
  colour = scaled(0.40 + 0.65 * lit + fade, colours[face]);
  return true;
}

Vec sky(double x, double y, double t) {
  const Vec clear =
      mix({0.28, 0.50, 0.86}, {0.97, 0.84, 0.68}, smooth_step(0, 7.5, y + 0.6 * std::sin(0.3 * x + t)));
  const double cloud = smooth_step(0.5, 0.9, ripple(0.35 * x + 0.5 * t, 0.8 * y));
  return mix(clear, {1, 0.98, 0.95}, 0.6 * cloud);
}

/// A flat colour with a dark outline inside a shape. @param depth below its border, in scene units.
void ink(Vec& colour, double depth, const Vec& flat) {
  if (depth > 0) colour = depth < 0.09 ? Vec{0.08, 0.07, 0.10} : flat;
}

double in_ellipse(double x, double y, double rx, double ry) {
  return (1 - std::hypot(x / rx, y / ry)) * std::min(rx, ry);
}

}  // namespace

Colour balls_scene(double x, double y, const std::array<double, 3>& t, Vec2 wall_shift) {
  const auto balls = balls_at(t);
  Vec colour = wall(x + wall_shift.x, y + wall_shift.y);
  for (const Ball& b : balls) {
    const double away = std::hypot((x - b.x - 0.7) / b.rx, (y - b.y - 0.8) / b.ry);
    colour = scaled(1 - 0.5 * (1 - smooth_step(0.75, 1.25, away)), colour);
  }
  for (const Ball& b : balls) {
    const double u = (x - b.x) / b.rx;
    const double v = (y - b.y) / b.ry;
    if (u * u + v * v < 1) colour = shaded(b.colour, {u, v, std::sqrt(1 - u * u - v * v)});
  }
  return colour;
}

Colour hills_scene(double x, double y, double t) {
  Vec colour = sky(x, y, t);
  for (int layer = 0; layer < 3; ++layer) {
    const double u = x + (0.3 + 0.5 * layer) * t + 7 * layer;
    const double top = 6.2 + 0.85 * layer + 0.5 * std::sin(0.55 * u) + 0.2 * std::sin(1.6 * u);
    if (y < top) continue;
    const Vec green = mix({0.45, 0.58, 0.60}, {0.12, 0.32, 0.14}, 0.5 * layer);
    colour = scaled(1.1 - 0.12 * std::min(y - top, 3.0), green);
  }
  box(x, y, t, colour);
  return colour;
}

Colour cartoon_scene(double x, double y, double t) {
  Vec colour{0.55, 0.80, 0.95};
  ink(colour, in_ellipse(x - 13.2, y - 1.8, 1.1, 1.1), {0.99, 0.86, 0.25});
  for (int cloud = 0; cloud < 3; ++cloud) {
    const double u = x - std::fmod(5.5 * cloud + 0.6 * t, 18.0) + 1;
    ink(colour, in_ellipse(u, y - 1.5 - 0.6 * cloud, 1.5, 0.5), {0.97, 0.97, 0.99});
  }
  ink(colour, y - 6.3 - 0.7 * std::sin(0.6 * x), {0.45, 0.75, 0.35});
  ink(colour, y - 7.6 - 0.3 * std::sin(0.9 * x + 2), {0.78, 0.62, 0.40});
  const double u = x - 3 - 2.2 * t;
  const double v = y - 5.6 + 1.3 * std::abs(std::sin(std::numbers::pi * t));
  ink(colour, in_ellipse(u, v, 1.6, 1.8), {0.90, 0.30, 0.30});
  ink(colour, in_ellipse(u - 0.6, v + 0.5, 0.45, 0.55), {0.98, 0.98, 0.98});
  ink(colour, in_ellipse(u + 0.6, v + 0.5, 0.45, 0.55), {0.98, 0.98, 0.98});
  ink(colour, 0.5 - std::hypot(u, 2.5 * (v - 0.7 + 0.2 * u * u)), {0.60, 0.10, 0.15});
  return colour;
}

image::Image draw_scene(int width, int height, int samples,
                        const std::function<Colour(double u, double v)>& scene) {
  image::Image image = image::make_image(width, height, 3);
  parallel_for(std::size_t(height), [&](std::size_t row) {
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < samples * samples; ++k) {
        const double u = (x + (k % samples + 0.5) / samples) / width;
        const double v = (double(row) + (k / samples + 0.5) / samples) / height;
        const Colour colour = scene(u, v);
        for (int c = 0; c < 3; ++c) {
          const double sample = 255 * std::clamp(colour[std::size_t(c)], 0.0, 1.0);
          image.at(x, int(row), c) += float(sample / (samples * samples));
        }
      }
    }
  });
  return image;
}

}  // namespace knotreel::media
