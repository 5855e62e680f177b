// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/mixed_equations.h"

#include <vector>

namespace knotreel::fit {

NormalEquations mixed_equations(const spline::Basis& basis, const MixedPixels& mixed, const Sought& sought,
                                int channels) {
  using Matrix = Eigen::SparseMatrix<double>;
  const spline::ScatteredValues values = basis.evaluate(mixed.places);
  const auto count = static_cast<Eigen::Index>(mixed.pixels.size());
  Eigen::MatrixXd colours(count, channels);
  std::vector<Eigen::Triplet<double>> entries;  // function, pixel, value
  entries.reserve(values.values.size());
  for (std::size_t i = 0; i < mixed.pixels.size(); ++i) {
    const auto pixel = static_cast<Eigen::Index>(i);
    for (Eigen::Index c = 0; c < channels; ++c)
      colours(pixel, c) = static_cast<double>(mixed.colours[i * std::size_t(channels) + std::size_t(c)]);
    for (std::size_t place = mixed.begin[i]; place < mixed.begin[i + 1]; ++place) {
      for (std::size_t v = values.begin[place]; v < values.begin[place + 1]; ++v) {
        const spline::FunctionIndex f = values.values[v].function;
        const double value = mixed.shares[place] * values.values[v].value;
        if (sought.has(f)) {
          entries.emplace_back(static_cast<int>(sought.number_of[f]), static_cast<int>(i), value);
        } else {
          for (Eigen::Index c = 0; c < channels; ++c)
            colours(pixel, c) -= value * sought.known[f * std::size_t(channels) + std::size_t(c)];
        }
      }
    }
  }
  Matrix rows(static_cast<Eigen::Index>(sought.functions.size()), count);
  rows.setFromTriplets(entries.begin(), entries.end());
  const Eigen::Map<const Eigen::VectorXd> weights(mixed.weights.data(), count);
  const Matrix weighted = rows * weights.asDiagonal();
  const Matrix products = weighted * rows.transpose();
  return {products.triangularView<Eigen::Lower>(), weighted * colours};
}

}  // namespace knotreel::fit
