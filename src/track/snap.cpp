// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/snap.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"

namespace knotreel::track {
namespace {

// Times SnapOptions::stiffness, by samples, of each end its share.
constexpr double kAgainstMoving = 0.3;
constexpr double kAgainstMovingApart = 0.5;
constexpr double kBeside = 1.5;  // from a curve to what is beside it, pixels

/// Moves of the ends that meet the offsets of the samples.
std::vector<Vec2> solve(const std::vector<EdgeSample>& samples, std::size_t knots,
                        const SnapOptions& options) {
  std::vector<int> column(knots, -1);
  std::vector<mesh::KnotIndex> ends;
  for (const EdgeSample& s : samples) {
    for (const mesh::KnotIndex k : {s.a, s.b}) {
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
  for (const EdgeSample& s : samples) {
    const int a = 2 * column[s.a];
    const int b = 2 * column[s.b];
    const int at[4] = {a, a + 1, b, b + 1};
    const double row[4] = {(1 - s.t) * s.normal.x, (1 - s.t) * s.normal.y, s.t * s.normal.x,
                           s.t * s.normal.y};
    for (int i = 0; i < 4; ++i) {
      right[at[i]] += s.weight * row[i] * s.offset;
      for (int j = 0; j < 4; ++j) add(at[i], at[j], s.weight * row[i] * row[j]);
    }
    const double stiff = options.stiffness * std::max(s.weight, kWeakestEdge);
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
    if (norm(d) > options.search.reach) d = (options.search.reach / norm(d)) * d;
    if (norm(d) > 0.1 * options.search.dead_zone) moves[ends[i]] = d;
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
  return most >= kWeakestEdge;
}

std::vector<std::uint8_t> lost_segments(const std::vector<EdgeSample>& samples, const image::Image& before,
                                        std::size_t segments, const SnapOptions& options) {
  std::vector<double> all(segments, 0);
  std::vector<double> parting(segments, 0);
  std::vector<double> known(segments, 0);
  std::vector<double> found(segments, 0);
  for (const EdgeSample& s : samples) {
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

}  // namespace

SnapResult snap_to_edges(const spline::Basis& basis, std::span<const Vec2> displacement,
                         const mesh::KnotMesh& mesh, std::span<const Vec2> motion,
                         const image::Image& picture_before, const motion::Luma& before,
                         const motion::Luma& now, const SnapOptions& options) {
  SnapResult result{std::vector<Vec2>(mesh.knots.size()), std::vector<std::uint8_t>(mesh.segments.size(), 0)};
  if (mesh.segments.empty()) return result;
  std::vector<EdgeSample> samples = place_samples(basis, displacement, mesh, motion);
  for (EdgeSample& s : samples) find_edge(steepest_at(before, s.before, s.normal), now, options.search, s);
  result.lost = lost_segments(samples, picture_before, mesh.segments.size(), options);
  // The ends of segments resist, so one round leaves a part of the way.
  for (int round = 0; round < options.rounds; ++round) {
    const bool any =
        std::any_of(samples.begin(), samples.end(), [](const EdgeSample& s) { return s.offset != 0; });
    if (!any) break;
    const std::vector<Vec2> more = solve(samples, mesh.knots.size(), options);
    for (std::size_t k = 0; k < more.size(); ++k) result.moves[k] = result.moves[k] + more[k];
    if (round + 1 == options.rounds) break;
    for (EdgeSample& s : samples) {
      s.position = s.position + (1 - s.t) * more[s.a] + s.t * more[s.b];
      find_edge(steepest_at(before, s.before, s.normal), now, options.search, s);
    }
  }
  return result;
}

}  // namespace knotreel::track
