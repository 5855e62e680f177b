// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/edge_points.h"

#include <cmath>

namespace knotreel::track {
namespace {

/// Looks for the edges next to the samples of curves at rest, of the direction that most of each segment has.
/// @param slope_of the slope of a sample that tells the direction.
template <class SlopeOf>
void find_edges_along(const motion::Luma& luma, std::size_t segments, const EdgeSearch& search,
                      SlopeOf&& slope_of, std::vector<EdgeSample>& samples) {
  std::vector<double> slopes(segments, 0);
  std::vector<double> counts(segments, 0);
  for (const EdgeSample& s : samples) {
    slopes[s.segment] += slope_of(s);
    counts[s.segment] += 1;
  }
  for (EdgeSample& s : samples) find_edge(slopes[s.segment] / counts[s.segment], luma, search, s);
}

}  // namespace

EdgePoints find_edge_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                            const motion::Luma& now, const EdgeSearch& search) {
  const mesh::KnotMesh& mesh = basis.space().mesh();
  EdgePoints result;
  if (mesh.segments.empty()) return result;
  const std::vector<Vec2> still(mesh.knots.size());
  std::vector<EdgeSample> samples = place_samples(basis, displacement, mesh, still);
  find_edges_along(
      now, mesh.segments.size(), search,
      [&](const EdgeSample& s) { return steepest_at(now, s.position, s.normal); }, samples);
  double squares = 0;
  for (const EdgeSample& s : samples) {
    squares += s.offset * s.offset;
    const Vec2 from = mesh.knots[s.a].position;
    result.points.push_back(
        {from + s.t * (mesh.knots[s.b].position - from), s.position + s.offset * s.normal});
  }
  result.rms = std::sqrt(squares / static_cast<double>(samples.size()));
  return result;
}

double mean_edge_distance(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const motion::Luma& picture) {
  const EdgeSearch search{.dead_zone = 0};
  const mesh::KnotMesh& mesh = basis.space().mesh();
  const std::vector<Vec2> still(mesh.knots.size());
  std::vector<EdgeSample> samples = place_samples(basis, displacement, mesh, still);
  find_edges_along(
      picture, mesh.segments.size(), search,
      [&](const EdgeSample& s) { return steepest_near(picture, s.position, s.normal, search.reach); },
      samples);
  double sum = 0;
  double found = 0;
  for (const EdgeSample& s : samples) {
    if (s.weight <= 0) continue;
    sum += std::abs(s.offset);
    found += 1;
  }
  return found > 0 ? sum / found : 0;
}

}  // namespace knotreel::track
