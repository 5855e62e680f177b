// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "knotreel/base/parallel.h"
#include "scene.h"

// A small ray caster: spheres, a solid of revolution and two planes, one lamp, one soft ambient light. Scene
// units: the table is the plane y = 0, y points up, the camera looks along +z.
namespace knotreel::media {
namespace {

struct Vec {
  double x = 0, y = 0, z = 0;
};
Vec operator+(Vec a, Vec b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(Vec a, Vec b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator*(double s, Vec a) {
  return {s * a.x, s * a.y, s * a.z};
}
Vec operator*(Vec a, Vec b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
double dot(Vec a, Vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec normalised(Vec a) {
  return 1 / std::sqrt(dot(a, a)) * a;
}
double smooth_step(double from, double to, double t) {
  t = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
Vec mix(Vec a, Vec b, double t) {
  return (1 - t) * a + t * b;
}

/// Repeatable noise in [0,1] on a grid, interpolated.
double lattice(std::int64_t x, std::int64_t y) {
  auto h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15U +
           static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fU;
  h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9U;
  return static_cast<double>((h ^ (h >> 32)) & 0xffff) / 65535;
}
double noise(double x, double y) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx);
  const auto iy = static_cast<std::int64_t>(fy);
  const double u = smooth_step(0, 1, x - fx);
  const double v = smooth_step(0, 1, y - fy);
  return (1 - v) * ((1 - u) * lattice(ix, iy) + u * lattice(ix + 1, iy)) +
         v * ((1 - u) * lattice(ix, iy + 1) + u * lattice(ix + 1, iy + 1));
}

struct Hit {
  double distance = 1e30;
  Vec point;
  Vec normal;
  Vec colour;  // linear, 0..1
  double gloss = 0;
};

const Vec kLamp{-4.5, 6.5, -3.5};

void hit_sphere(Vec origin, Vec ray, Vec centre, Vec radii, Hit& hit, auto&& surface) {
  // An ellipsoid is a unit sphere in scaled space.
  const Vec inverse{1 / radii.x, 1 / radii.y, 1 / radii.z};
  const Vec o = inverse * (origin - centre);
  const Vec d = inverse * ray;
  const double a = dot(d, d);
  const double b = dot(o, d);
  const double root = b * b - a * (dot(o, o) - 1);
  if (root < 0) return;
  const double t = (-b - std::sqrt(root)) / a;
  if (t < 1e-6 || t >= hit.distance) return;
  hit.distance = t;
  hit.point = origin + t * ray;
  hit.normal = normalised(inverse * (inverse * (hit.point - centre)));
  surface(hit, inverse * (hit.point - centre));
}

/// Radius of the vase over its height, 0..2.4.
double vase_radius(double y) {
  const double s = y / 2.4;
  return 0.30 + 0.42 * std::sin(std::numbers::pi * std::pow(s, 0.75)) * (1 - 0.35 * s) +
         0.12 * smooth_step(0.86, 1, s);
}

/// Marched, since the profile is free-form.
void hit_vase(Vec origin, Vec ray, Hit& hit) {
  const Vec centre{-1.55, 0, 2.3};
  const auto outside = [&](Vec p) {
    const double r = std::hypot(p.x - centre.x, p.z - centre.z);
    if (p.y > 2.4) return std::max(p.y - 2.4, r - 0.9);
    return r - vase_radius(std::max(p.y, 0.0));
  };
  double t = 0;
  for (int step = 0; step < 400 && t < hit.distance; ++step) {
    const Vec p = origin + t * ray;
    const double gap = outside(p);
    if (gap < 1e-4) {
      if (p.y > 2.4 || p.y < 0 || t < 1e-3) return;
      hit.distance = t;
      hit.point = p;
      const double slope = (vase_radius(p.y + 1e-4) - vase_radius(p.y - 1e-4)) / 2e-4;
      const double r = std::hypot(p.x - centre.x, p.z - centre.z);
      hit.normal = normalised({(p.x - centre.x) / r, -slope, (p.z - centre.z) / r});
      const double angle = std::atan2(p.x - centre.x, p.z - centre.z);
      const double zigzag = 1.15 + 0.10 * std::abs(std::fmod(angle * 7 / std::numbers::pi + 14, 2.0) - 1);
      const bool band =
          std::abs(p.y - zigzag) < 0.05 || std::abs(p.y - 0.98) < 0.015 || std::abs(p.y - 1.42) < 0.015;
      hit.colour = band ? Vec{0.80, 0.62, 0.22} : Vec{0.05, 0.22, 0.36};
      hit.gloss = 0.7;
      return;
    }
    t += 0.5 * gap;
    if (t > 40) return;
  }
}

void hit_table(Vec origin, Vec ray, Hit& hit) {
  if (ray.y >= -1e-9) return;
  const double t = -origin.y / ray.y;
  const Vec p = origin + t * ray;
  if (t < 1e-6 || t >= hit.distance || p.z > 4.2) return;
  hit.distance = t;
  hit.point = p;
  hit.normal = {0, 1, 0};
  // The cloth: a rotated square with stripes; around it wood with grain.
  const double u = 0.94 * p.x + 0.34 * p.z - 1.25;
  const double v = -0.34 * p.x + 0.94 * p.z - 0.75;
  if (std::abs(u) < 1.25 && std::abs(v) < 0.85) {
    const double stripe = std::fmod(u + 10, 0.25);
    const bool border = std::abs(u) > 1.19 || std::abs(v) > 0.79;
    hit.colour = border          ? Vec{0.42, 0.03, 0.05}
                 : stripe < 0.06 ? Vec{0.55, 0.06, 0.07}
                                 : Vec{0.78, 0.74, 0.66};
    return;
  }
  const double ring = p.x * 3.2 + 0.6 * noise(p.x * 1.5, p.z * 0.4);
  const double grain = 0.5 + 0.5 * std::sin(9 * ring + 4 * noise(p.x * 6, p.z * 0.9));
  const double fine = noise(p.x * 60, p.z * 5);
  hit.colour = mix({0.30, 0.15, 0.06}, {0.46, 0.25, 0.11}, 0.65 * grain + 0.35 * fine);
  hit.gloss = 0.06;
}

/// The wall with a window; thin glazing bars. It glows a little where the window is.
void hit_wall(Vec origin, Vec ray, Hit& hit) {
  if (ray.z < 1e-9) return;
  const double t = (4.2 - origin.z) / ray.z;
  if (t < 1e-6 || t >= hit.distance) return;
  hit.distance = t;
  hit.point = origin + t * ray;
  hit.normal = {0, 0, -1};
  hit.colour = {0.36, 0.40, 0.36};
}

bool in_shadow(Vec point) {
  Hit blocker;
  const Vec to_lamp = kLamp - point;
  const Vec ray = normalised(to_lamp);
  const Vec start = point + 1e-3 * ray;
  const auto ignore = [](Hit&, Vec) {};
  hit_sphere(start, ray, {0.15, 0.62, 1.9}, {0.66, 0.62, 0.66}, blocker, ignore);
  hit_sphere(start, ray, {1.55, 0.36, 1.15}, {0.46, 0.36, 0.36}, blocker, ignore);
  hit_vase(start, ray, blocker);
  return blocker.distance * blocker.distance < dot(to_lamp, to_lamp);
}

Vec window(Vec p) {
  const double u = (p.x - 1.9) / 1.05;
  const double v = (p.y - 2.35) / 1.0;
  if (std::abs(u) > 1 || std::abs(v) > 1) return {-1, 0, 0};
  const bool bar =
      std::abs(u) < 0.025 || std::abs(v - 0.2) < 0.018 || std::abs(u) > 0.95 || std::abs(v) > 0.94;
  if (bar) return {0.75, 0.72, 0.65};
  const Vec sky = mix({0.95, 0.85, 0.65}, {0.30, 0.52, 0.85}, smooth_step(-0.5, 1, v));
  const double hill = -0.45 + 0.12 * std::sin(2.1 * u + 0.4) + 0.05 * std::sin(6.3 * u);
  return v < hill ? mix({0.10, 0.20, 0.12}, {0.22, 0.34, 0.22}, smooth_step(-1, hill, v)) : sky;
}

Vec trace(Vec origin, Vec ray) {
  Hit hit;
  hit_wall(origin, ray, hit);
  if (hit.distance < 1e29 && hit.point.y > 0) {
    if (const Vec outside = window(hit.point); outside.x >= 0) {
      Hit front = hit;
      hit_vase(origin, ray, front);
      if (front.distance == hit.distance) return outside;
    }
  }
  hit_table(origin, ray, hit);
  hit_sphere(origin, ray, {0.15, 0.62, 1.9}, {0.66, 0.62, 0.66}, hit, [](Hit& h, Vec local) {
    const double blush =
        smooth_step(-0.6, 0.7, local.x + 0.4 * local.y + 0.25 * noise(3 * local.x + 9, 3 * local.y + 9));
    const double speckle = noise(28 * local.x + 50, 28 * local.y + 50) > 0.86 ? 0.12 : 0;
    h.colour = mix({0.62, 0.04, 0.04}, {0.55, 0.50, 0.08}, blush) + speckle * Vec{1, 0.9, 0.5};
    h.gloss = 0.5;
  });
  hit_sphere(origin, ray, {1.55, 0.36, 1.15}, {0.46, 0.36, 0.36}, hit, [](Hit& h, Vec) {
    h.colour = {0.82, 0.72, 0.60};
    h.gloss = 0.1;
  });
  hit_vase(origin, ray, hit);

  const Vec to_lamp = normalised(kLamp - hit.point);
  const double lit = in_shadow(hit.point) ? 0 : std::max(0.0, dot(hit.normal, to_lamp));
  const Vec ambient = mix({0.16, 0.13, 0.11}, {0.30, 0.34, 0.40}, 0.5 + 0.5 * hit.normal.y);
  Vec colour = hit.colour * (ambient + lit * Vec{1.05, 0.98, 0.86});
  if (hit.gloss > 0 && lit > 0) {
    const Vec half = normalised(to_lamp - ray);
    colour = colour + hit.gloss * std::pow(std::max(0.0, dot(hit.normal, half)), 60) * Vec{1, 0.97, 0.9};
  }
  return colour;
}

float encode_srgb(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<float>(255 * encoded);
}

/// The stalk of the apple and a wire hanging from above: thin lines, drawn in picture units.
double line_coverage(double x, double y, double width) {
  const double wire = std::abs(x - (0.43 + 0.012 * std::sin(13 * y)));
  double inside = y < 0.27 && wire < width * 0.5 ? 1 : 0;
  const double s = (0.462 - y) / 0.075;
  if (s > 0 && s < 1 && std::abs(x - (0.505 + 0.022 * s * s)) < width * 1.1) inside = 1;
  return inside;
}

}  // namespace

image::Image still_life(int width, int height) {
  constexpr int kSamples = 4;
  image::Image image = image::make_image(width, height, 3);
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      Vec sum;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double px = (x + (k % kSamples + 0.5) / kSamples) / width;
        const double py = (y + (k / kSamples + 0.5) / kSamples) / height;
        if (line_coverage(px, py, 1.5 / width) > 0) {
          sum = sum + Vec{0.02, 0.015, 0.01};
          continue;
        }
        const Vec ray = normalised({(px - 0.5) * 1.5, (0.5 - py) - 0.29, 1.55});
        const Vec colour = trace({0.1, 2.05, -3.2}, ray);
        // Each sample is limited first, as a sensor would, so that bright edges are antialiased too.
        sum = sum + Vec{std::min(colour.x, 1.0), std::min(colour.y, 1.0), std::min(colour.z, 1.0)};
      }
      const double scale = 1.0 / (kSamples * kSamples);
      const std::array<double, 3> mean{scale * sum.x, scale * sum.y, scale * sum.z};
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = encode_srgb(mean[static_cast<std::size_t>(c)]);
    }
  });
  return image;
}

}  // namespace knotreel::media
