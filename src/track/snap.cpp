// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/snap.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/small_vector.h"
#include "knotreel/base/error.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

namespace {

using mesh::KnotIndex;
using mesh::KnotMesh;

constexpr double kSpacing = 1.5;  // of samples along a curve, pixels
constexpr double kStep = 0.5;     // of samples across it
constexpr double kCertain = 20;   // levels over two steps: steeper edges have a smaller dead zone
constexpr double kWeakest = 6;    // levels over two steps; less is no edge
// Times SnapOptions::stiffness, by samples, of each end its share.
constexpr double kAgainstMoving = 0.3;
constexpr double kAgainstMovingApart = 0.5;
constexpr double kBeside = 1.5;  // from a curve to what is beside it, pixels

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

struct Sample {
  KnotIndex a = 0;
  KnotIndex b = 0;
  double t = 0;   ///< share of the way from a to b
  Vec2 before;    ///< in the picture before
  Vec2 position;  ///< in the new one, as far as the motion is known
  Vec2 normal;
  double offset = 0;   ///< along the normal
  double weight = 0;   ///< steepness; 0: nothing found
  bool known = false;  ///< there was an edge before
  std::size_t segment = 0;
};

/// Places of samples along all segments, in the image of the surface, moved with their ends.
std::vector<Sample> place_samples(const spline::Basis& basis, std::span<const Vec2> displacement,
                                  const KnotMesh& mesh, std::span<const Vec2> motion) {
  std::vector<Sample> samples;
  std::vector<Vec2> points;
  for (std::size_t segment = 0; segment < mesh.segments.size(); ++segment) {
    const mesh::FeatureSegment& s = mesh.segments[segment];
    const KnotIndex a = s.knots.front();
    const KnotIndex b = s.knots.back();
    const Vec2 from = mesh.knots[a].position;
    const Vec2 along = mesh.knots[b].position - from;
    const int n = std::max(3, static_cast<int>(std::lround(norm(along) / kSpacing)));
    for (int i = 0; i <= n; ++i) {
      Sample sample{a, b, static_cast<double>(i) / n, {}, {}, {}};
      sample.segment = segment;
      points.push_back(from + sample.t * along);
      samples.push_back(sample);
    }
  }
  points = fit::image_points(basis, displacement, std::move(points));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& s = samples[i];
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

/// Slope of the luma along a normal, levels over two steps.
double slope_at(const motion::Luma& luma, Vec2 p, Vec2 normal) {
  return luma_at(luma, p + kStep * normal) - luma_at(luma, p + (-kStep) * normal);
}

/// The steepest slope within half a pixel.
double steepest_at(const motion::Luma& luma, Vec2 p, Vec2 normal) {
  double steepest = 0;
  for (const double d : {-0.5, 0.0, 0.5}) {
    const double slope = slope_at(luma, p + d * normal, normal);
    if (std::abs(slope) > std::abs(steepest)) steepest = slope;
  }
  return steepest;
}

/// The place along the normal with a slope most like a known one, nearer ones preferred.
void find_edge(double known, const motion::Luma& now, const SnapOptions& options, Sample& s) {
  s.offset = s.weight = 0;
  if (std::abs(known) < kWeakest) return;
  s.known = true;
  const int reach = static_cast<int>(std::lround(options.reach / kStep));
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
    const double far = (i - 1 - reach) * kStep / (options.reach + 1);
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
  const double dead = options.dead_zone * std::clamp(kCertain / s.weight, 0.2, 1.0);
  if (std::abs(s.offset) < dead) s.offset = 0;
}

/// Moves of the ends that meet the offsets of the samples.
std::vector<Vec2> solve(const std::vector<Sample>& samples, std::size_t knots, const SnapOptions& options) {
  std::vector<int> column(knots, -1);
  std::vector<KnotIndex> ends;
  for (const Sample& s : samples) {
    for (const KnotIndex k : {s.a, s.b}) {
      if (column[k] >= 0) continue;
      column[k] = static_cast<int>(ends.size());
      ends.push_back(k);
    }
  }
  const auto n = static_cast<Eigen::Index>(2 * ends.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  const auto add = [&](int i, int j, double v) {
    if (i >= j) entries.emplace_back(i, j, v);
  };
  for (const Sample& s : samples) {
    const int a = 2 * column[s.a];
    const int b = 2 * column[s.b];
    const int at[4] = {a, a + 1, b, b + 1};
    const double row[4] = {(1 - s.t) * s.normal.x, (1 - s.t) * s.normal.y, s.t * s.normal.x,
                           s.t * s.normal.y};
    for (int i = 0; i < 4; ++i) {
      right[at[i]] += s.weight * row[i] * s.offset;
      for (int j = 0; j < 4; ++j) add(at[i], at[j], s.weight * row[i] * row[j]);
    }
    const double stiff = options.stiffness * std::max(s.weight, kWeakest);
    for (int i = 0; i < 2; ++i) {
      // Against moving, and against moving apart.
      add(a + i, a + i, stiff * (kAgainstMovingApart + kAgainstMoving * (1 - s.t)) + 1e-9);
      add(b + i, b + i, stiff * (kAgainstMovingApart + kAgainstMoving * s.t) + 1e-9);
      add(std::max(a, b) + i, std::min(a, b) + i, -kAgainstMovingApart * stiff);
    }
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
  std::vector<Vec2> moves(knots);
  if (factor.info() != Eigen::Success)
    throw Error(ErrorKind::kInternal, "the moves of feature curves cannot be solved for");
  const Eigen::VectorXd x = factor.solve(right);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Vec2 d{x[static_cast<Eigen::Index>(2 * i)], x[static_cast<Eigen::Index>(2 * i + 1)]};
    if (norm(d) > options.reach) d = (options.reach / norm(d)) * d;
    if (norm(d) > 0.1 * options.dead_zone) moves[ends[i]] = d;
  }
  return moves;
}

/// Whether the colours on both sides of a curve differ, which is what the curve is for.
bool parts_colours(const image::Image& picture, Vec2 p, Vec2 normal) {
  const auto pixel = [&](Vec2 q) {
    const int x = std::clamp(static_cast<int>(std::floor(q.x)), 0, picture.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(q.y)), 0, picture.height - 1);
    return picture.row(y).data() + x * picture.channels;
  };
  const float* left = pixel(p + kBeside * normal);
  const float* right = pixel(p + (-kBeside) * normal);
  float most = 0;
  for (int c = 0; c < picture.channels; ++c) most = std::max(most, std::abs(left[c] - right[c]));
  return most >= kWeakest;
}

std::vector<std::uint8_t> lost_segments(const std::vector<Sample>& samples, const image::Image& before,
                                        std::size_t segments, const SnapOptions& options) {
  std::vector<double> all(segments, 0);
  std::vector<double> parting(segments, 0);
  std::vector<double> known(segments, 0);
  std::vector<double> found(segments, 0);
  for (const Sample& s : samples) {
    all[s.segment] += 1;
    parting[s.segment] += parts_colours(before, s.before, s.normal) ? 1 : 0;
    known[s.segment] += s.known ? 1 : 0;
    found[s.segment] += s.weight > 0 ? 1 : 0;
  }
  std::vector<std::uint8_t> lost(segments, 0);
  for (std::size_t i = 0; i < segments; ++i) {
    lost[i] =
        found[i] < options.least_found * known[i] || parting[i] < options.least_parting * all[i] ? 1 : 0;
  }
  return lost;
}

/// Looks for the edges next to the samples of curves at rest, of the direction that most of each segment has.
/// @param slope_of the slope of a sample that tells the direction.
template <class SlopeOf>
void find_edges_along(const motion::Luma& luma, std::size_t segments, const SnapOptions& options,
                      SlopeOf&& slope_of, std::vector<Sample>& samples) {
  std::vector<double> slopes(segments, 0);
  std::vector<double> counts(segments, 0);
  for (const Sample& s : samples) {
    slopes[s.segment] += slope_of(s);
    counts[s.segment] += 1;
  }
  for (Sample& s : samples) find_edge(slopes[s.segment] / counts[s.segment], luma, options, s);
}

/// The steepest slope within reach, nearer ones preferred.
double steepest_near(const motion::Luma& luma, Vec2 p, Vec2 normal, double reach) {
  double steepest = 0;
  for (double d = -reach; d <= reach; d += kStep) {
    const double far = d / (reach + 1);
    const double slope = slope_at(luma, p + d * normal, normal) * (1 - 0.6 * far * far);
    if (std::abs(slope) > std::abs(steepest)) steepest = slope;
  }
  return steepest;
}

}  // namespace

SnapResult snap_to_edges(const spline::Basis& basis, std::span<const Vec2> displacement, const KnotMesh& mesh,
                         std::span<const Vec2> motion, const image::Image& picture_before,
                         const motion::Luma& before, const motion::Luma& now, const SnapOptions& options) {
  SnapResult result{std::vector<Vec2>(mesh.knots.size()), std::vector<std::uint8_t>(mesh.segments.size(), 0)};
  if (mesh.segments.empty()) return result;
  std::vector<Sample> samples = place_samples(basis, displacement, mesh, motion);
  for (Sample& s : samples) find_edge(steepest_at(before, s.before, s.normal), now, options, s);
  result.lost = lost_segments(samples, picture_before, mesh.segments.size(), options);
  // The ends of segments resist, so one round leaves a part of the way.
  for (int round = 0; round < options.rounds; ++round) {
    const bool any =
        std::any_of(samples.begin(), samples.end(), [](const Sample& s) { return s.offset != 0; });
    if (!any) break;
    const std::vector<Vec2> more = solve(samples, mesh.knots.size(), options);
    for (std::size_t k = 0; k < more.size(); ++k) result.moves[k] = result.moves[k] + more[k];
    if (round + 1 == options.rounds) break;
    for (Sample& s : samples) {
      s.position = s.position + (1 - s.t) * more[s.a] + s.t * more[s.b];
      find_edge(steepest_at(before, s.before, s.normal), now, options, s);
    }
  }
  return result;
}

EdgePoints find_edge_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                            const motion::Luma& now, const SnapOptions& options) {
  const KnotMesh& mesh = basis.space().mesh();
  EdgePoints result;
  if (mesh.segments.empty()) return result;
  const std::vector<Vec2> still(mesh.knots.size());
  std::vector<Sample> samples = place_samples(basis, displacement, mesh, still);
  find_edges_along(
      now, mesh.segments.size(), options,
      [&](const Sample& s) { return steepest_at(now, s.position, s.normal); }, samples);
  double squares = 0;
  for (const Sample& s : samples) {
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
  const SnapOptions options{.dead_zone = 0};
  const KnotMesh& mesh = basis.space().mesh();
  const std::vector<Vec2> still(mesh.knots.size());
  std::vector<Sample> samples = place_samples(basis, displacement, mesh, still);
  find_edges_along(
      picture, mesh.segments.size(), options,
      [&](const Sample& s) { return steepest_near(picture, s.position, s.normal, options.reach); }, samples);
  double sum = 0;
  double found = 0;
  for (const Sample& s : samples) {
    if (s.weight <= 0) continue;
    sum += std::abs(s.offset);
    found += 1;
  }
  return found > 0 ? sum / found : 0;
}

}  // namespace knotreel::track
