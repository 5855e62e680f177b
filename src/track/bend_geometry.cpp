#include "track/bend_geometry.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

namespace knotreel::track {

namespace {

constexpr double kStiffness = 0.3;  // of control points against changing, relative to a point of a curve

std::vector<std::uint8_t> on_sides(const spline::SplineSpace& space) {
  std::vector<std::uint8_t> result;
  for (const Vec2 s : space.geometry_greville()) {
    result.push_back(s.x <= 0 || s.y <= 0 || s.x >= space.mesh().width || s.y >= space.mesh().height);
  }
  return result;
}

}  // namespace

void bend_geometry(const spline::Basis& basis, std::span<const fit::CurvePoint> points,
                   std::vector<Vec2>& displacement) {
  std::vector<Vec2> parameters;
  for (const fit::CurvePoint& p : points) parameters.push_back(p.parameter);
  const spline::ScatteredValues values = basis.evaluate(parameters);
  const std::vector<Vec2> now = fit::image_points(basis, displacement, std::move(parameters));
  const std::vector<std::uint8_t> fixed = on_sides(basis.space());
  std::vector<int> column(displacement.size(), -1);
  std::vector<std::uint32_t> groups;
  const auto column_of = [&](const spline::BasisValue& v) {
    const std::uint32_t group = basis.space().geometry_of()[v.function];
    if (column[group] < 0 && !fixed[group]) {
      column[group] = static_cast<int>(groups.size());
      groups.push_back(group);
    }
    return column[group];
  };
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Vec2> right;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 miss = points[i].position - now[i];
    for (std::size_t a = values.begin[i]; a < values.begin[i + 1]; ++a) {
      const int r = column_of(values.values[a]);
      if (r < 0) continue;
      right.resize(groups.size());
      right[static_cast<std::size_t>(r)] = right[static_cast<std::size_t>(r)] + values.values[a].value * miss;
      for (std::size_t b = values.begin[i]; b < values.begin[i + 1]; ++b) {
        const int c = column_of(values.values[b]);
        if (c >= 0 && c <= r) entries.emplace_back(r, c, values.values[a].value * values.values[b].value);
      }
    }
  }
  right.resize(groups.size());
  const auto n = static_cast<Eigen::Index>(groups.size());
  if (n == 0) return;
  for (int i = 0; i < static_cast<int>(n); ++i) entries.emplace_back(i, i, kStiffness);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
  if (factor.info() != Eigen::Success) return;
  Eigen::MatrixXd wanted(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    wanted(i, 0) = right[static_cast<std::size_t>(i)].x;
    wanted(i, 1) = right[static_cast<std::size_t>(i)].y;
  }
  const Eigen::MatrixXd change = factor.solve(wanted);
  for (Eigen::Index i = 0; i < n; ++i) {
    Vec2& d = displacement[groups[static_cast<std::size_t>(i)]];
    d = d + Vec2{change(i, 0), change(i, 1)};
  }
}

}  // namespace knotreel::track
