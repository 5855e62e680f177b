#include "knotreel/fit/geometry_fit.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>

#include "fit/normal_equations.h"
#include "knotreel/base/error.h"

namespace knotreel::fit {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Displacements as a picture of two channels.
image::Image displacement_picture(const GeometrySamples& samples) {
  image::Image image{samples.width, samples.height, 2, {}};
  image.samples.resize(2 * samples.position.size());
  for (std::size_t i = 0; i < samples.position.size(); ++i) {
    const Vec2 d = samples.position[i] - samples.parameter[i];
    image.samples[2 * i] = static_cast<float>(d.x);
    image.samples[2 * i + 1] = static_cast<float>(d.y);
  }
  return image;
}

/// Columns: groups that may move; rows: functions.
Matrix group_matrix(const spline::SplineSpace& space, std::vector<std::uint32_t>& moving) {
  const std::vector<Vec2> sites = space.geometry_greville();
  std::vector<int> column(sites.size(), -1);
  for (std::uint32_t g = 0; g < sites.size(); ++g) {
    const Vec2 s = sites[g];
    if (s.x <= 0 || s.y <= 0 || s.x >= space.mesh().width || s.y >= space.mesh().height) continue;
    column[g] = static_cast<int>(moving.size());
    moving.push_back(g);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t f = 0; f < space.function_count(); ++f) {
    const int c = column[space.geometry_of()[f]];
    if (c >= 0) entries.emplace_back(static_cast<int>(f), c, 1.0);
  }
  Matrix groups(static_cast<Eigen::Index>(space.function_count()), static_cast<Eigen::Index>(moving.size()));
  groups.setFromTriplets(entries.begin(), entries.end());
  return groups;
}

}  // namespace

std::vector<Vec2> fit_geometry(const spline::Basis& basis, const GeometrySamples& samples,
                               const GeometryFitOptions& options) {
  const spline::SplineSpace& space = basis.space();
  std::vector<Vec2> displacement(space.geometry_count());
  if (samples.position.size() != samples.parameter.size() ||
      samples.on_feature.size() != samples.position.size()) {
    throw Error(ErrorKind::kInvalidArgument, "samples of the geometry fit disagree in number");
  }
  const image::Image image = displacement_picture(samples);
  if (std::all_of(image.samples.begin(), image.samples.end(), [](float v) { return v == 0; })) {
    return displacement;
  }
  std::vector<float> weights(samples.on_feature.size(), 1.0F);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (samples.on_feature[i]) weights[i] = static_cast<float>(options.feature_weight);
  }
  const PixelValues values(basis, {.image = &image, .weights = weights, .places = samples.parameter});
  const NormalEquations normal = assemble(values);
  std::vector<std::uint32_t> moving;
  const Matrix groups = group_matrix(space, moving);
  if (moving.empty()) return displacement;
  const Matrix full = normal.matrix.selfadjointView<Eigen::Lower>();
  Matrix reduced = groups.transpose() * full * groups;
  const double ridge = options.ridge * std::max(1.0, Eigen::VectorXd(reduced.diagonal()).maxCoeff());
  for (Eigen::Index i = 0; i < reduced.rows(); ++i) reduced.coeffRef(i, i) += ridge;
  const Eigen::CholmodSimplicialLDLT<Matrix, Eigen::Lower> factor(reduced);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::kInternal, "the normal equations of the geometry fit cannot be factored");
  }
  const Eigen::MatrixXd solution = factor.solve(Eigen::MatrixXd(groups.transpose() * normal.right));
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Vec2 d{solution(static_cast<Eigen::Index>(i), 0), solution(static_cast<Eigen::Index>(i), 1)};
    if (norm(d) >= options.least) displacement[moving[i]] = d;
  }
  return displacement;
}

}  // namespace knotreel::fit
