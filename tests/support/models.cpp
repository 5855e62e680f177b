// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/models.h"

#include <random>

#include "knotreel/spline/basis.h"

namespace knotreel::testing {

document::FrameModel blank_model(const mesh::KnotMesh& mesh, int degree, int channels) {
  document::FrameModel model;
  model.space = std::make_shared<const spline::SplineSpace>(mesh, degree);
  model.displacement.resize(model.space->geometry_count());
  model.channels = channels;
  model.colour.resize(model.space->function_count() * static_cast<std::size_t>(channels));
  return model;
}

namespace {

/// Smallest determinant of the Jacobian of the geometry over a lattice of points.
double smallest_jacobian(const document::FrameModel& model) {
  const spline::Basis basis(model.space);
  const auto& mesh = model.space->mesh();
  std::vector<spline::BasisJet> jets;
  double smallest = 1;
  constexpr int kSteps = 80;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const Vec2 u{(i % kSteps + 0.37) / kSteps * mesh.width,
                 (static_cast<double>(i / kSteps) + 0.61) / kSteps * mesh.height};
    basis.evaluate(u, spline::inward_direction(u, mesh.width, mesh.height), jets);
    double j[2][2] = {{1, 0}, {0, 1}};
    for (const spline::BasisJet& b : jets) {
      const Vec2 d = model.displacement[model.space->geometry_of()[b.function]];
      j[0][0] += d.x * b.jet.dx;
      j[0][1] += d.x * b.jet.dy;
      j[1][0] += d.y * b.jet.dx;
      j[1][1] += d.y * b.jet.dy;
    }
    smallest = std::min(smallest, j[0][0] * j[1][1] - j[0][1] * j[1][0]);
  }
  return smallest;
}

}  // namespace

void displace_randomly(document::FrameModel& model, double reach, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  const auto& mesh = model.space->mesh();
  const std::vector<Vec2> sites = model.space->geometry_greville();
  for (std::size_t g = 0; g < sites.size(); ++g) {
    Vec2 d{unit(random), unit(random)};
    if (sites[g].x == 0 || sites[g].x == mesh.width) d.x = 0;
    if (sites[g].y == 0 || sites[g].y == mesh.height) d.y = 0;
    model.displacement[g] = d;
  }
  while (smallest_jacobian(model) < 0.3) {
    for (Vec2& d : model.displacement) d = 0.7 * d;
  }
}

void colour_randomly(document::FrameModel& model, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 255);
  for (double& c : model.colour) c = unit(random);
}

}  // namespace knotreel::testing
