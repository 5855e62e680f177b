// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/uniform_fit.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/mesh/triangulate.h"

namespace knotreel::fit {

namespace {

/// Basis functions per knot in a large mesh without features, by degree (counted).
double functions_per_knot(int degree) {
  return degree == 1 ? 1.0 : degree == 2 ? 2.5 : 3.9;
}

/// Offsets in [-1, 1) that are the same on every machine, unlike those of std::uniform_real_distribution.
class Jitter {
 public:
  explicit Jitter(std::uint64_t seed) : random_(seed) {}
  double next() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1.0; }

 private:
  std::mt19937_64 random_;
};

}  // namespace

mesh::KnotMesh uniform_mesh(double width, double height, double spacing, std::uint64_t seed) {
  mesh::KnotMesh mesh = mesh::make_domain(width, height);
  Jitter jitter(seed);
  const auto add = [&](Vec2 p, mesh::KnotKind kind) {
    mesh.knots.push_back({p, kind, mesh::KnotId{static_cast<std::uint32_t>(mesh.knots.size())}});
  };
  const auto pieces = [spacing](double length) {
    return std::max(1, static_cast<int>(std::lround(length / spacing)));
  };
  const int columns = pieces(width);
  for (int i = 1; i < columns; ++i) {
    add({width * (i + 0.1 * jitter.next()) / columns, 0}, mesh::KnotKind::kBorder);
    add({width * (i + 0.1 * jitter.next()) / columns, height}, mesh::KnotKind::kBorder);
  }
  const int side_rows = pieces(height);
  for (int i = 1; i < side_rows; ++i) {
    add({0, height * (i + 0.1 * jitter.next()) / side_rows}, mesh::KnotKind::kBorder);
    add({width, height * (i + 0.1 * jitter.next()) / side_rows}, mesh::KnotKind::kBorder);
  }
  const int rows = std::max(1, static_cast<int>(std::lround(height / (spacing * std::sqrt(0.75)))));
  for (int r = 1; r < rows; ++r) {
    // Every other row is shifted by half a spacing; knots keep half a spacing off the sides.
    const double shift = r % 2 == 0 ? 0.0 : 0.5;
    for (int c = r % 2 == 0 ? 1 : 0; c < columns; ++c) {
      const double x = width * (c + shift + 0.1 * jitter.next()) / columns;
      const double y = height * (r + 0.1 * jitter.next()) / rows;
      add({x, y}, mesh::KnotKind::kFree);
    }
  }
  mesh::triangulate(mesh);
  return mesh;
}

document::FrameModel fit_uniform(const image::Image& image, const UniformFitOptions& options) {
  if (image.width < 1 || image.height < 1) {
    throw Error(ErrorKind::kInvalidArgument, "cannot fit a picture without pixels");
  }
  const double width = image.width;
  const double height = image.height;
  const double wanted =
      options.control_points > 0 ? static_cast<double>(options.control_points) : 0.02 * width * height;
  // A hexagonal lattice has sqrt(3)/2 spacing^2 of area per knot; fewer knots than four corners there cannot
  // be.
  const double knots = std::max(wanted / functions_per_knot(options.degree), 1.0);
  const double spacing = std::sqrt(width * height / knots / std::sqrt(0.75));

  document::FrameModel model;
  model.space = std::make_shared<const spline::SplineSpace>(
      uniform_mesh(width, height, spacing, options.seed), options.degree);
  model.displacement.resize(model.space->geometry_count());
  model.channels = image.channels;
  model.colour = fit_colours(spline::Basis(model.space), {.image = &image}, options.colour).control;
  return model;
}

}  // namespace knotreel::fit
