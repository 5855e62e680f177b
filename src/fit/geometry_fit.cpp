// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/geometry_fit.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <array>
#include <atomic>

#include "fit/joints.h"
#include "fit/normal_equations.h"
#include "fit/pixel_centre.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::PixelValues;
using Matrix = Eigen::SparseMatrix<double>;

/// What the surface must add to each place, as a picture of two channels.
image::Image displacement_picture(std::span<const Vec2> places, int width, int height) {
  image::Image image{width, height, 2, {}};
  image.samples.resize(2 * places.size());
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    for (std::size_t i = row * std::size_t(width); i < (row + 1) * std::size_t(width); ++i) {
      const Vec2 d = centre_of_pixel(i, width) - places[i];
      image.samples[2 * i] = static_cast<float>(d.x);
      image.samples[2 * i + 1] = static_cast<float>(d.y);
    }
  });
  return image;
}

/// Functions with a displaced pixel in their support, and those that share a geometry control point with one.
std::vector<std::uint8_t> active_functions(const PixelValues& values, std::span<const Vec2> places) {
  constexpr std::size_t kPixels = PixelValues::kTilePixels;
  const spline::SplineSpace& space = values.basis().space();
  std::vector<std::uint8_t> group(space.geometry_count(), 0);  // only ever set
  parallel_for(values.tile_count(), [&](std::size_t t) {
    std::array<std::uint8_t, kPixels> displaced{};
    bool any = false;
    values.for_pixels(t, [&](std::size_t pixel, std::size_t place) {
      displaced[place] = places[pixel] != centre_of_pixel(pixel, values.width());
      any = any || displaced[place];
    });
    if (!any) return;
    thread_local std::vector<double> at;
    const auto functions = values.functions(t);
    at.resize(functions.size() * kPixels);
    values.evaluate(t, at.data());
    for (std::size_t f = 0; f < functions.size(); ++f) {
      const std::atomic_ref active(group[space.geometry_of()[functions[f]]]);
      bool reached = active.load(std::memory_order_relaxed) != 0;
      for (std::size_t i = 0; i < kPixels && !reached; ++i) {
        reached = displaced[i] && at[f * kPixels + i] != 0;
        if (reached) active.store(1, std::memory_order_relaxed);
      }
    }
  });
  std::vector<std::uint8_t> active(space.function_count());
  for (std::size_t f = 0; f < active.size(); ++f) active[f] = group[space.geometry_of()[f]];
  return active;
}

/// The control points that are solved for: a column for each geometry group that is active and off the
/// border.
struct Unknowns {
  std::vector<int> column;            ///< by geometry group, or -1
  std::vector<std::uint32_t> groups;  ///< by column
};

Unknowns find_unknowns(const spline::SplineSpace& space, const std::vector<std::uint8_t>& active) {
  const std::vector<Vec2> sites = space.geometry_greville();
  std::vector<std::uint8_t> wanted(sites.size(), 0);
  for (std::size_t f = 0; f < active.size(); ++f) {
    if (active[f]) wanted[space.geometry_of()[f]] = 1;
  }
  Unknowns unknowns;
  unknowns.column.assign(sites.size(), -1);
  for (std::uint32_t g = 0; g < sites.size(); ++g) {
    if (!wanted[g] || mesh::on_side(space.mesh(), sites[g])) continue;
    unknowns.column[g] = static_cast<int>(unknowns.groups.size());
    unknowns.groups.push_back(g);
  }
  return unknowns;
}

/// Normal equations of the unknowns: those of the functions folded, and the points of the curves.
struct Folded {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right;
};

Folded fold(const NormalEquations& normal, const spline::SplineSpace& space, const Unknowns& unknowns) {
  Folded folded;
  folded.right.setZero(static_cast<Eigen::Index>(unknowns.groups.size()), 2);
  const auto column_of = [&](Eigen::Index f) {
    return unknowns.column[space.geometry_of()[static_cast<std::size_t>(f)]];
  };
  for (Eigen::Index f = 0; f < normal.matrix.outerSize(); ++f) {
    const int c = column_of(f);
    if (c < 0) continue;
    folded.right.row(c) += normal.right.row(f);
    for (Matrix::InnerIterator it(normal.matrix, f); it; ++it) {
      const int r = column_of(it.row());
      if (r < 0) continue;
      folded.entries.emplace_back(std::max(r, c), std::min(r, c), it.value());
      // Two functions of one group: both orders of the pair fall on the diagonal.
      if (r == c && it.row() != f) folded.entries.emplace_back(r, c, it.value());
    }
  }
  return folded;
}

/// That the sum of the terms should be what is wanted.
void add_row(std::span<const GeometryTerm> terms, Vec2 wanted, double weight, const Unknowns& unknowns,
             Folded& folded) {
  for (const GeometryTerm& a : terms) {
    const int r = unknowns.column[a.group];
    if (r < 0) continue;
    const double v = weight * a.factor;
    folded.right(r, 0) += v * wanted.x;
    folded.right(r, 1) += v * wanted.y;
    for (const GeometryTerm& b : terms) {
      const int c = unknowns.column[b.group];
      if (c >= 0 && c <= r) folded.entries.emplace_back(r, c, v * b.factor);
    }
  }
}

void add_curves(const spline::Basis& basis, std::span<const CurvePoint> curves, double weight,
                const Unknowns& unknowns, Folded& folded) {
  std::vector<Vec2> points;
  points.reserve(curves.size());
  for (const CurvePoint& p : curves) points.push_back(p.parameter);
  const spline::ScatteredValues values = basis.evaluate(points);
  std::vector<GeometryTerm> terms;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    terms.clear();
    for (std::size_t a = values.begin[i]; a < values.begin[i + 1]; ++a)
      terms.push_back({basis.space().geometry_of()[values.values[a].function], values.values[a].value});
    add_row(terms, curves[i].position - curves[i].parameter, weight, unknowns, folded);
  }
}

}  // namespace

std::vector<Vec2> fit_geometry(const spline::PixelValues& values, std::span<const Vec2> places,
                               std::span<const CurvePoint> curves, const GeometryFitOptions& options) {
  const spline::SplineSpace& space = values.basis().space();
  std::vector<Vec2> displacement(space.geometry_count());
  if (places.empty()) return displacement;
  const image::Image target = displacement_picture(places, values.width(), values.height());
  const std::vector<std::uint8_t> active = active_functions(values, places);
  const Unknowns unknowns = find_unknowns(space, active);
  if (unknowns.groups.empty()) return displacement;
  const PixelValues wanted(values.basis(), values.width(), values.height(), places, active);
  Folded folded = fold(assemble<double>(wanted, target, {}), space, unknowns);
  add_curves(values.basis(), curves, options.feature_weight, unknowns, folded);
  if (options.joint_weight > 0) {
    for (const JointEquation& e : joint_equations(space, joints_of(curves)))
      add_row(e.terms, e.wanted, options.joint_weight * options.feature_weight, unknowns, folded);
  }
  const auto n = static_cast<Eigen::Index>(unknowns.groups.size());
  Matrix matrix(n, n);
  matrix.setFromTriplets(folded.entries.begin(), folded.entries.end());
  const double ridge = options.ridge * std::max(1.0, Eigen::VectorXd(matrix.diagonal()).maxCoeff());
  for (Eigen::Index i = 0; i < n; ++i) matrix.coeffRef(i, i) += ridge;
  const Eigen::CholmodSimplicialLDLT<Matrix, Eigen::Lower> factor(matrix);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::kInternal, "the normal equations of the geometry fit cannot be factored");
  }
  const Eigen::MatrixXd solution = factor.solve(folded.right);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec2 d{solution(i, 0), solution(i, 1)};
    if (norm(d) >= options.least) displacement[unknowns.groups[static_cast<std::size_t>(i)]] = d;
  }
  return displacement;
}

std::vector<double> geometry_errors(const spline::Basis& basis, std::span<const Vec2> displacement,
                                    std::span<const CurvePoint> curves) {
  std::vector<double> errors(curves.size());
  basis.index();
  constexpr std::size_t kPoints = 64;
  parallel_for((curves.size() + kPoints - 1) / kPoints, [&](std::size_t block) {
    std::vector<spline::BasisValue> values;
    for (std::size_t i = block * kPoints; i < std::min(curves.size(), (block + 1) * kPoints); ++i) {
      Vec2 at = curves[i].parameter;
      basis.evaluate(curves[i].parameter, values);
      for (const auto& v : values) at = at + v.value * displacement[basis.space().geometry_of()[v.function]];
      errors[i] = norm(at - curves[i].position);
    }
  });
  return errors;
}

}  // namespace knotreel::fit
