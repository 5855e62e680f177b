// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/bend_geometry.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <limits>
#include <utility>

#include "fit/joints.h"
#include "knotreel/base/error.h"

namespace knotreel::track {

namespace {

// Weights, relative to that of a point of a curve.
constexpr double kJoint = 0.5;     // of a joint, where two segments are one smooth curve
constexpr double kScreen = 0.005;  // of its displacement, if it reaches a curve
constexpr double kAway = 0.5;      // more of that, if it does not and its neighbours are far away
constexpr double kFar = 2;         // pixels to the nearest of them, for half of it
constexpr int kRings = 3;          // of control points around the curves that may change
constexpr double kFade = 0.125;    // pixels that displacements elsewhere lose: nothing asks for them

using NetEdge = std::pair<std::uint32_t, std::uint32_t>;

/// Neighbours in the net of the geometry's control points.
std::vector<NetEdge> net_edges(const spline::SplineSpace& space) {
  std::vector<NetEdge> edges;
  for (const spline::Config& config : space.configs()) {
    for (std::size_t v = 0; v < 3; ++v) {
      const spline::FunctionIndex f = config.functions[v];
      const spline::FunctionIndex g = config.functions[(v + 1) % 3];
      if (f == spline::kNoFunction || g == spline::kNoFunction) continue;
      const NetEdge edge = std::minmax(space.geometry_of()[f], space.geometry_of()[g]);
      if (edge.first != edge.second) edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Least-squares displacements of the control points around some curves, x and y apart.
class ElasticSheet {
 public:
  ElasticSheet(const spline::Basis& basis, std::span<const fit::CurvePoint> points,
               std::span<const Vec2> displacement, std::span<const std::uint8_t> held, const Sheet& sheet)
      : sheet_(sheet),
        space_(basis.space()),
        before_(displacement.begin(), displacement.end()),
        held_(held),
        sites_(space_.geometry_greville()),
        edges_(net_edges(space_)) {
    std::vector<Vec2> parameters;
    for (const fit::CurvePoint& p : points) parameters.push_back(p.parameter);
    const spline::ScatteredValues values = basis.evaluate(parameters);
    find_rings(values);
    find_nearest();
    choose_rows();
    point_right_ = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(groups_.size()), 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto here =
          std::span(values.values).subspan(values.begin[i], values.begin[i + 1] - values.begin[i]);
      add_point(here, points[i].position - points[i].parameter);
    }
    for (const fit::JointEquation& e : fit::joint_equations(space_, fit::joints_of(points)))
      add_row(e.terms, e.wanted, kJoint);
  }

  void solve(std::vector<Vec2>& displacement) const {
    const auto n = static_cast<Eigen::Index>(groups_.size());
    if (n == 0) return;
    std::vector<Eigen::Triplet<double>> entries = point_entries_;
    Eigen::MatrixXd right = point_right_;
    const auto pull = [&](int row, double weight, Vec2 to) {
      right(row, 0) += weight * to.x;
      right(row, 1) += weight * to.y;
    };
    for (const auto& [a, b] : edges_) {
      const Vec2 d = sites_[a] - sites_[b];
      const double stiffness = sheet_.stiffness / (dot(d, d) + 1);  // never much more than a point
      const double weight = stiffness + sheet_.elasticity / (dot(d, d) + 1);
      const Vec2 difference = before_[a] - before_[b];
      const int i = row_of_[a];
      const int j = row_of_[b];
      if (i >= 0) pull(i, stiffness, difference);
      if (j >= 0) pull(j, -stiffness, difference);
      if (i >= 0) entries.emplace_back(i, i, weight);
      if (j >= 0) entries.emplace_back(j, j, weight);
      if (i >= 0 && j >= 0) entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
      if (i >= 0 && j < 0) pull(i, weight, before_[b]);
      if (j >= 0 && i < 0) pull(j, weight, before_[a]);
    }
    for (int i = 0; i < static_cast<int>(n); ++i) {
      const std::uint32_t g = groups_[static_cast<std::size_t>(i)];
      entries.emplace_back(i, i, sheet_.inertia + screen(g));
      pull(i, sheet_.inertia, before_[g]);
    }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
    if (factor.info() != Eigen::Success)
      throw Error(ErrorKind::kInternal, "the bending of feature curves cannot be solved for");
    const Eigen::MatrixXd result = factor.solve(right);
    for (Eigen::Index i = 0; i < n; ++i)
      displacement[groups_[static_cast<std::size_t>(i)]] = {result(i, 0), result(i, 1)};
  }

  /// Displacements that no curve asks for any more spread from frame to frame, and cost time and bytes.
  void fade_others(std::vector<Vec2>& displacement) const {
    for (std::uint32_t g = 0; g < displacement.size(); ++g) {
      if (ring_of_[g] <= kRings || is_held(g)) continue;
      const double length = norm(displacement[g]);
      displacement[g] = length <= kFade ? Vec2{} : (1 - kFade / length) * displacement[g];
    }
  }

 private:
  bool is_held(std::uint32_t g) const { return !held_.empty() && held_[g]; }

  /// Large faces can stay where they are. Thin ones would be turned over.
  double screen(std::uint32_t g) const {
    if (ring_of_[g] == 0) return kScreen;
    return kScreen + kAway * (1 - kFar * kFar / (nearest_[g] + kFar * kFar));
  }

  /// Those that reach the curves, and rings of neighbours around them.
  void find_rings(const spline::ScatteredValues& values) {
    ring_of_.assign(before_.size(), kRings + 1);
    for (const spline::BasisValue& v : values.values) ring_of_[space_.geometry_of()[v.function]] = 0;
    for (int ring = 1; ring <= kRings; ++ring) {
      for (const auto& [a, b] : edges_) {
        if (ring_of_[a] == ring - 1) ring_of_[b] = std::min(ring_of_[b], ring);
        if (ring_of_[b] == ring - 1) ring_of_[a] = std::min(ring_of_[a], ring);
      }
    }
  }

  void find_nearest() {
    nearest_.assign(sites_.size(), std::numeric_limits<double>::infinity());
    for (const auto& [a, b] : edges_) {
      const Vec2 d = sites_[a] - sites_[b];
      nearest_[a] = std::min(nearest_[a], dot(d, d));
      nearest_[b] = std::min(nearest_[b], dot(d, d));
    }
  }

  void choose_rows() {
    row_of_.assign(ring_of_.size(), -1);
    for (std::uint32_t g = 0; g < ring_of_.size(); ++g) {
      if (ring_of_[g] > kRings || is_held(g) || mesh::on_side(space_.mesh(), sites_[g])) continue;
      row_of_[g] = static_cast<int>(groups_.size());
      groups_.push_back(g);
    }
  }

  void add_point(std::span<const spline::BasisValue> values, Vec2 wanted) {
    terms_.clear();
    for (const spline::BasisValue& v : values) terms_.push_back({space_.geometry_of()[v.function], v.value});
    add_row(terms_, wanted, 1);
  }

  /// That the sum of the terms should be what is wanted. Control points that stay bring what they have.
  void add_row(std::span<const fit::GeometryTerm> terms, Vec2 wanted, double weight) {
    for (const fit::GeometryTerm& t : terms) {
      if (row_of_[t.group] < 0) wanted = wanted - t.factor * before_[t.group];
    }
    for (const fit::GeometryTerm& a : terms) {
      const int r = row_of_[a.group];
      if (r < 0) continue;
      const double v = weight * a.factor;
      point_right_(r, 0) += v * wanted.x;
      point_right_(r, 1) += v * wanted.y;
      for (const fit::GeometryTerm& b : terms) {
        const int c = row_of_[b.group];
        if (c >= 0 && c <= r) point_entries_.emplace_back(r, c, v * b.factor);
      }
    }
  }

  Sheet sheet_;
  const spline::SplineSpace& space_;
  std::vector<Vec2> before_;
  std::span<const std::uint8_t> held_;
  std::vector<Vec2> sites_;
  std::vector<NetEdge> edges_;
  std::vector<double> nearest_;  ///< neighbour of each group: squared distance
  std::vector<int> ring_of_;     ///< by geometry group; 0: reaches a curve
  std::vector<int> row_of_;      ///< by geometry group; -1: keeps its displacement
  std::vector<std::uint32_t> groups_;
  std::vector<fit::GeometryTerm> terms_;  ///< of a point
  std::vector<Eigen::Triplet<double>> point_entries_;
  Eigen::MatrixXd point_right_;
};

}  // namespace

void bend_geometry(const spline::Basis& basis, std::span<const fit::CurvePoint> points,
                   std::vector<Vec2>& displacement, std::span<const std::uint8_t> held, const Sheet& sheet) {
  const ElasticSheet elastic(basis, points, displacement, held, sheet);
  elastic.solve(displacement);
  elastic.fade_others(displacement);
}

}  // namespace knotreel::track
