// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/edge_samples.h"

#include <algorithm>
#include <cmath>

#include "base/small_vector.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {
namespace {

constexpr double kSpacing = 1.5;  // of samples along a curve, pixels
constexpr double kStep = 0.5;     // of samples across it
constexpr double kCertain = 20;   // levels over two steps: steeper edges have a smaller dead zone

double luma_at(const motion::Luma& luma, Vec2 p) {
  const double x = std::clamp(p.x - 0.5, 0.0, luma.width - 1.0);
  const double y = std::clamp(p.y - 0.5, 0.0, luma.height - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(0, luma.width - 2));
  const int y0 = std::min(static_cast<int>(y), std::max(0, luma.height - 2));
  const int x1 = std::min(x0 + 1, luma.width - 1);
  const int y1 = std::min(y0 + 1, luma.height - 1);
  const auto v = [&](int i, int j) {
    return static_cast<double>(luma.v[std::size_t(j) * std::size_t(luma.width) + std::size_t(i)]);
  };
  const double fx = x - x0;
  const double fy = y - y0;
  return (1 - fy) * ((1 - fx) * v(x0, y0) + fx * v(x1, y0)) + fy * ((1 - fx) * v(x0, y1) + fx * v(x1, y1));
}

/// Slope of the luma along a normal, levels over two steps.
double slope_at(const motion::Luma& luma, Vec2 p, Vec2 normal) {
  return luma_at(luma, p + kStep * normal) - luma_at(luma, p + (-kStep) * normal);
}

}  // namespace

std::vector<EdgeSample> place_samples(const spline::Basis& basis, std::span<const Vec2> displacement,
                                      const mesh::KnotMesh& mesh, std::span<const Vec2> motion) {
  std::vector<EdgeSample> samples;
  std::vector<Vec2> points;
  for (std::size_t segment = 0; segment < mesh.segments.size(); ++segment) {
    const mesh::FeatureSegment& s = mesh.segments[segment];
    const mesh::KnotIndex a = s.knots.front();
    const mesh::KnotIndex b = s.knots.back();
    const Vec2 from = mesh.knots[a].position;
    const Vec2 along = mesh.knots[b].position - from;
    const int n = std::max(3, static_cast<int>(std::lround(norm(along) / kSpacing)));
    for (int i = 0; i <= n; ++i) {
      EdgeSample sample{a, b, static_cast<double>(i) / n, {}, {}, {}};
      sample.segment = segment;
      points.push_back(from + sample.t * along);
      samples.push_back(sample);
    }
  }
  points = fit::image_points(basis, displacement, std::move(points));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EdgeSample& s = samples[i];
    s.before = points[i];
    s.position = s.before + (1 - s.t) * motion[s.a] + s.t * motion[s.b];
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool first = i == 0 || samples[i - 1].a != samples[i].a || samples[i - 1].b != samples[i].b;
    const bool last =
        i + 1 == samples.size() || samples[i + 1].a != samples[i].a || samples[i + 1].b != samples[i].b;
    const Vec2 d = samples[last ? i : i + 1].position - samples[first ? i : i - 1].position;
    const double length = norm(d);
    if (length > 0) samples[i].normal = {-d.y / length, d.x / length};
  }
  return samples;
}

double steepest_at(const motion::Luma& luma, Vec2 p, Vec2 normal) {
  double steepest = 0;
  for (const double d : {-0.5, 0.0, 0.5}) {
    const double slope = slope_at(luma, p + d * normal, normal);
    if (std::abs(slope) > std::abs(steepest)) steepest = slope;
  }
  return steepest;
}

double steepest_near(const motion::Luma& luma, Vec2 p, Vec2 normal, double reach) {
  double steepest = 0;
  for (double d = -reach; d <= reach; d += kStep) {
    const double far = d / (reach + 1);
    const double slope = slope_at(luma, p + d * normal, normal) * (1 - 0.6 * far * far);
    if (std::abs(slope) > std::abs(steepest)) steepest = slope;
  }
  return steepest;
}

void find_edge(double known, const motion::Luma& now, const EdgeSearch& search, EdgeSample& s) {
  s.offset = s.weight = 0;
  if (std::abs(known) < kWeakestEdge) return;
  s.known = true;
  const int reach = static_cast<int>(std::lround(search.reach / kStep));
  SmallVector<double, 64> steep;
  for (int i = -reach - 1; i <= reach + 1; ++i) {
    const double slope = slope_at(now, s.position + (i * kStep) * s.normal, s.normal);
    steep.push_back(known > 0 ? slope : -slope);
  }
  int best = -1;
  double most = 0;
  for (int i = 1; i + 1 < static_cast<int>(steep.size()); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (steep[at] < 0.5 * std::abs(known) || steep[at] < steep[at - 1] || steep[at] < steep[at + 1]) continue;
    const double far = (i - 1 - reach) * kStep / (search.reach + 1);
    const double value = std::min(steep[at], std::abs(known)) * (1 - 0.6 * far * far);
    if (value <= most) continue;
    most = value;
    best = i;
  }
  if (best < 0) return;
  const auto at = static_cast<std::size_t>(best);
  const double bend = steep[at - 1] - 2 * steep[at] + steep[at + 1];
  const double part = bend < 0 ? 0.5 * (steep[at - 1] - steep[at + 1]) / bend : 0;
  s.offset = (best - 1 - reach + std::clamp(part, -0.5, 0.5)) * kStep;
  s.weight = steep[at];
  // Strong edges say more exactly where they are.
  const double dead = search.dead_zone * std::clamp(kCertain / s.weight, 0.2, 1.0);
  if (std::abs(s.offset) < dead) s.offset = 0;
}

}  // namespace knotreel::track
