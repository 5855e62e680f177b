// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/smooth_corners.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <map>
#include <numeric>

namespace knotreel::spline {

namespace {

/// Disjoint sets of corners.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  CornerIndex find(CornerIndex c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void join(CornerIndex a, CornerIndex b) { parent_[find(b)] = find(a); }

 private:
  std::vector<CornerIndex> parent_;
};

using FewCorners = boost::container::static_vector<CornerIndex, kMaxDegree>;

/// The distinct multiple corners of a function.
FewCorners multiple_corners(const SplineSpace& space, FunctionIndex f) {
  FewCorners corners;
  for (const CornerIndex c : space.functions()[f].knots) {
    if (c != kNoCorner && space.cut().corners[c].multiple && (corners.empty() || corners.back() != c)) {
      corners.push_back(c);
    }
  }
  return corners;
}

/// One value per monomial.
using Monomials = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 6>;

/// Polar forms, at I without one copy of `corner`, of the monomials of degree <= k-1 around the corner.
Monomials polar_monomials(const SplineSpace& space, FunctionIndex f, CornerIndex corner, double scale) {
  boost::container::static_vector<Vec2, kMaxDegree> rest;
  bool left_out = false;
  for (int i = 0; i < space.degree(); ++i) {
    const CornerIndex c = space.functions()[f].knots[static_cast<std::size_t>(i)];
    if (c == corner && !left_out) {
      left_out = true;
      continue;
    }
    rest.push_back((1 / scale) * (space.position(c) - space.position(corner)));
  }
  Monomials row;
  if (rest.empty()) {
    row.resize(1);
    row << 1;
  } else if (rest.size() == 1) {
    row.resize(3);
    row << 1, rest[0].x, rest[0].y;
  } else {
    const Vec2 p = rest[0];
    const Vec2 q = rest[1];
    row.resize(6);
    row << 1, 0.5 * (p.x + q.x), 0.5 * (p.y + q.y), p.x * q.x, 0.5 * (p.x * q.y + p.y * q.x), p.y * q.y;
  }
  return row;
}

/// All control points of the functions of one group of corners, as an orthonormal basis of what is smooth.
Eigen::MatrixXd group_prolongation(const SplineSpace& space, const std::vector<FunctionIndex>& functions) {
  std::vector<CornerIndex> corners;
  for (const FunctionIndex f : functions) {
    for (const CornerIndex c : multiple_corners(space, f)) corners.push_back(c);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());

  double scale = 0;  // a length of the fans keeps the monomials near 1
  for (const FunctionIndex f : functions) {
    for (const CornerIndex c : space.functions()[f].knots) {
      if (c == kNoCorner) continue;
      const Vec2 d = space.position(c) - space.position(space.functions()[f].knots[0]);
      scale = std::max(scale, norm(d));
    }
  }
  if (scale == 0) scale = 1;

  const Eigen::Index dofs = space.degree() == 1 ? 1 : space.degree() == 2 ? 3 : 6;
  const auto parameters = dofs * static_cast<Eigen::Index>(corners.size());
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(functions.size()), parameters);
  std::vector<Eigen::RowVectorXd> agreements;  // a function with two corners has one value
  for (std::size_t i = 0; i < functions.size(); ++i) {
    Eigen::RowVectorXd first;
    for (const CornerIndex c : multiple_corners(space, functions[i])) {
      const auto place = std::lower_bound(corners.begin(), corners.end(), c) - corners.begin();
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(parameters);
      row.segment(place * dofs, dofs) = polar_monomials(space, functions[i], c, scale);
      if (first.size() == 0) {
        first = row;
        values.row(static_cast<Eigen::Index>(i)) = row;
      } else {
        agreements.push_back(row - first);
      }
    }
  }
  if (!agreements.empty()) {
    Eigen::MatrixXd constraints(static_cast<Eigen::Index>(agreements.size()), parameters);
    for (std::size_t i = 0; i < agreements.size(); ++i) {
      constraints.row(static_cast<Eigen::Index>(i)) = agreements[i];
    }
    Eigen::FullPivLU<Eigen::MatrixXd> lu(constraints);
    lu.setThreshold(1e-10);
    values = values * lu.kernel();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(values);
  qr.setThreshold(1e-10);
  return qr.householderQ() * Eigen::MatrixXd::Identity(values.rows(), qr.rank());
}

}  // namespace

Eigen::SparseMatrix<double> smooth_corner_prolongation(const SplineSpace& space, SharedFunctions shared) {
  Groups groups(space.cut().corners.size());
  std::vector<CornerIndex> some_corner(space.function_count(), kNoCorner);
  for (FunctionIndex f = 0; f < space.function_count(); ++f) {
    const FewCorners corners = multiple_corners(space, f);
    if (corners.empty() || (corners.size() > 1 && shared == SharedFunctions::kFree)) continue;
    some_corner[f] = corners.front();
    for (const CornerIndex c : corners) groups.join(corners.front(), c);
  }
  std::map<CornerIndex, std::vector<FunctionIndex>> functions_of;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index column = 0;
  for (FunctionIndex f = 0; f < space.function_count(); ++f) {
    if (some_corner[f] == kNoCorner) {
      entries.emplace_back(static_cast<Eigen::Index>(f), column++, 1.0);
    } else {
      functions_of[groups.find(some_corner[f])].push_back(f);
    }
  }
  for (const auto& [corner, functions] : functions_of) {
    const Eigen::MatrixXd block = group_prolongation(space, functions);
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      for (Eigen::Index i = 0; i < block.rows(); ++i) {
        if (block(i, j) != 0) {
          entries.emplace_back(static_cast<Eigen::Index>(functions[static_cast<std::size_t>(i)]), column + j,
                               block(i, j));
        }
      }
    }
    column += block.cols();
  }
  Eigen::SparseMatrix<double> prolongation(static_cast<Eigen::Index>(space.function_count()), column);
  prolongation.setFromTriplets(entries.begin(), entries.end());
  return prolongation;
}

}  // namespace knotreel::spline
