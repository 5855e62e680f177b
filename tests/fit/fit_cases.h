// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"
#include "support/mesh_cases.h"

/// Meshes, places and slow references for the tests of the fits.
namespace knotreel::testing {

/// A mesh of 48 x 40 pixels with a bent feature, one that ends on the border, knots on all sides and about 16
/// free knots, none of them collinear by accident, and no pixel centre exactly on an edge.
inline mesh::KnotMesh featured_mesh(std::uint64_t seed) {
  MeshBuilder b(48, 40);
  const auto tip = b.vertex(10.137, 12.071);
  const auto bend = b.vertex(22.019, 18.313);
  b.segment(tip, bend, 1);
  b.segment(bend, b.vertex(35.083, 9.529), 2);
  b.segment(b.vertex(30.317, 40), b.vertex(26.051, 28.713), 1);
  b.border(17.237, 0);
  b.border(33.131, 0);
  b.border(0, 19.327);
  b.border(48, 22.119);
  b.border(12.641, 40);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) {
      const Vec2 p{4.8 + 9.6 * i + 1.5 * unit(random), 5.0 + 10.0 * j + 1.5 * unit(random)};
      bool close = false;
      for (const mesh::Knot& k : b.mesh().knots) close = close || norm(k.position - p) < 4;
      for (const auto& s : b.mesh().segments) {
        const Vec2 from = b.mesh().knots[s.knots.front()].position;
        const Vec2 along = b.mesh().knots[s.knots.back()].position - from;
        const double t = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
        close = close || norm(p - (from + t * along)) < 3;
      }
      if (!close) b.free(p.x, p.y);
    }
  }
  return b.triangulated();
}

inline Vec2 pixel_centre(std::size_t i, int width) {
  return {static_cast<double>(i % std::size_t(width)) + 0.5,
          static_cast<double>(i / std::size_t(width)) + 0.5};
}

/// Places up to `reach` from the centres by coordinate, a third of them exactly there.
inline std::vector<Vec2> scattered_places(int width, int height, double reach, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<Vec2> places(std::size_t(width) * std::size_t(height));
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = pixel_centre(i, width);
    if (random() % 3 == 0) continue;
    places[i] = {std::clamp(places[i].x + unit(random), 0.0, double(width)),
                 std::clamp(places[i].y + unit(random), 0.0, double(height))};
  }
  return places;
}

/// Zeros and ones, about one zero in five.
inline std::vector<float> random_weights(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<float> weights(count);
  for (float& w : weights) w = random() % 5 == 0 ? 0.0F : 1.0F;
  return weights;
}

inline std::vector<double> random_control(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 255);
  std::vector<double> control;
  for (std::size_t i = 0; i < count; ++i) control.push_back(unit(random));
  return control;
}

/// The surface at the pixels, point by point.
inline std::vector<double> slow_surface(const spline::Basis& basis, std::span<const double> control,
                                        int channels, int width, int height, std::span<const Vec2> places) {
  const auto n = std::size_t(channels);
  std::vector<double> out(std::size_t(width) * std::size_t(height) * n);
  std::vector<spline::BasisValue> values;
  for (std::size_t i = 0; i < out.size() / n; ++i) {
    basis.evaluate(places.empty() ? pixel_centre(i, width) : places[i], values);
    for (const auto& v : values) {
      for (std::size_t c = 0; c < n; ++c) out[i * n + c] += v.value * control[v.function * n + c];
    }
  }
  return out;
}

inline image::Image picture_of(std::span<const double> samples, int width, int height, int channels) {
  image::Image image = image::make_image(width, height, channels);
  std::transform(samples.begin(), samples.end(), image.samples.begin(),
                 [](double v) { return static_cast<float>(v); });
  return image;
}

inline std::shared_ptr<const spline::SplineSpace> make_space(const mesh::KnotMesh& mesh, int degree) {
  return std::make_shared<const spline::SplineSpace>(mesh, degree);
}

}  // namespace knotreel::testing
