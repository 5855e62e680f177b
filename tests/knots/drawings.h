// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/mesh/triangulate.h"

/// Pictures and meshes for tests of knots.
namespace knotreel::knots::testing {

/// A picture of f(x, y, channel) at the pixel centres.
template <class F>
image::Image drawn(int width, int height, int channels, F&& f) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = static_cast<float>(f(x + 0.5, y + 0.5, c));
    }
  }
  return image;
}

/// Smooth waves, about a hundred pixels long.
inline image::Image waves(int width, int height, int channels) {
  return drawn(width, height, channels, [](double x, double y, int c) {
    return 120 + 60 * std::sin(0.045 * x + c) * std::cos(0.06 * y) + 0.004 * x * y;
  });
}

/// A bright disc with a hard edge on a slope.
inline image::Image disc(int width, int height, int channels) {
  return drawn(width, height, channels, [=](double x, double y, int c) {
    return std::hypot(x - 0.4 * width, y - 0.55 * height) < 0.25 * height ? 200 - 20 * c : 50 + 0.3 * x;
  });
}

/// A domain with knots about `spacing` apart, jittered, some of them on the border.
inline mesh::KnotMesh scattered_mesh(double width, double height, double spacing, std::uint64_t seed) {
  mesh::KnotMesh mesh = mesh::make_domain(width, height);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  const auto add = [&](Vec2 p, mesh::KnotKind kind) {
    mesh.knots.push_back({p, kind, mesh::KnotId{static_cast<std::uint32_t>(mesh.knots.size())}});
  };
  for (int i = 1; i * spacing < width - 0.5 * spacing; ++i) {
    add({spacing * (i + jitter(random)), 0}, mesh::KnotKind::kBorder);
    add({spacing * (i + jitter(random)), height}, mesh::KnotKind::kBorder);
  }
  for (int j = 1; j * spacing < height - 0.5 * spacing; ++j) {
    add({0, spacing * (j + jitter(random))}, mesh::KnotKind::kBorder);
    add({width, spacing * (j + jitter(random))}, mesh::KnotKind::kBorder);
    for (int i = 1; i * spacing < width - 0.5 * spacing; ++i) {
      add({spacing * (i + jitter(random)), spacing * (j + jitter(random))}, mesh::KnotKind::kFree);
    }
  }
  mesh::triangulate(mesh);
  return mesh;
}

/// Fails with the defect of a mesh that has one.
inline void expect_sound(const mesh::EditableMesh& mesh) {
  const auto defect = find_defect(mesh.to_mesh());
  EXPECT_FALSE(defect) << *defect;
}

/// Distance of a point from the nearest feature or side of the domain.
inline double distance_to_lines(const mesh::EditableMesh& mesh, Vec2 p) {
  double least = std::fmin(std::fmin(p.x, mesh.width() - p.x), std::fmin(p.y, mesh.height() - p.y));
  for (const mesh::FeatureSegment& s : mesh.segments()) {
    least = std::fmin(least,
                      distance_to_segment(p, mesh.position(s.knots.front()), mesh.position(s.knots.back())));
  }
  return least;
}

}  // namespace knotreel::knots::testing
