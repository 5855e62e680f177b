#include "fit/mixed_equations.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// What a pixel is made of: functions, ascending, each once, and the means of their values over its places.
struct Mixture {
  std::vector<std::pair<spline::FunctionIndex, double>> parts;
};

Mixture mixture_of(const spline::ScatteredValues& values, const MixedPixels& mixed, std::size_t i) {
  Mixture mixture;
  for (std::size_t place = mixed.begin[i]; place < mixed.begin[i + 1]; ++place) {
    for (std::size_t v = values.begin[place]; v < values.begin[place + 1]; ++v) {
      const spline::FunctionIndex f = values.values[v].function;
      const double value = mixed.shares[place] * values.values[v].value;
      const auto same = std::find_if(mixture.parts.begin(), mixture.parts.end(),
                                     [&](const auto& p) { return p.first == f; });
      if (same == mixture.parts.end()) {
        mixture.parts.emplace_back(f, value);
      } else {
        same->second += value;
      }
    }
  }
  std::sort(mixture.parts.begin(), mixture.parts.end());
  return mixture;
}

}  // namespace

void add_mixed_pixels(const spline::Basis& basis, const MixedPixels& mixed, const Sought& sought,
                      NormalEquations& normal) {
  if (mixed.pixels.empty()) return;
  const spline::ScatteredValues values = basis.evaluate(mixed.places);
  const std::size_t count = mixed.pixels.size();
  const auto channels = static_cast<std::size_t>(normal.right.cols());
  Eigen::MatrixXd colours(static_cast<Eigen::Index>(count), normal.right.cols());
  std::vector<Mixture> mixtures(count);
  parallel_for(count, [&](std::size_t i) {
    const auto pixel = static_cast<Eigen::Index>(i);
    for (std::size_t c = 0; c < channels; ++c)
      colours(pixel, static_cast<Eigen::Index>(c)) = static_cast<double>(mixed.colours[i * channels + c]);
    mixtures[i] = mixture_of(values, mixed, i);
    std::erase_if(mixtures[i].parts, [&](const auto& part) {
      if (sought.has(part.first)) return false;
      for (std::size_t c = 0; c < channels; ++c)
        colours(pixel, static_cast<Eigen::Index>(c)) -= part.second * sought.known[part.first * channels + c];
      return true;
    });
  });
  std::vector<Eigen::Triplet<double>> entries;  // pixel, function, value
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [f, value] : mixtures[i].parts)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(sought.number_of[f]), value);
  }
  Matrix rows(static_cast<Eigen::Index>(count), normal.matrix.cols());
  rows.setFromTriplets(entries.begin(), entries.end());
  const Eigen::Map<const Eigen::VectorXd> weights(mixed.weights.data(), static_cast<Eigen::Index>(count));
  const Matrix weighted = Matrix(weights.asDiagonal() * rows).transpose();
  const Matrix products = weighted * rows;
  normal.matrix += Matrix(products.triangularView<Eigen::Lower>());
  normal.right += weighted * colours;
}

}  // namespace knotreel::fit
