#include "knotreel/fit/colour_fit.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/normal_equations.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/smooth_corners.h"

namespace knotreel::fit {

namespace {

/// Colours of the picture at the Greville sites: what control points fall back to where pixels say nothing.
Eigen::MatrixXd greville_colours(const spline::SplineSpace& space, const image::Image& image) {
  Eigen::MatrixXd prior(static_cast<Eigen::Index>(space.function_count()), image.channels);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const Vec2 site = space.greville(f);
    const int x = std::clamp(static_cast<int>(std::floor(site.x)), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(site.y)), 0, image.height - 1);
    for (int c = 0; c < image.channels; ++c) {
      prior(static_cast<Eigen::Index>(f), c) = static_cast<double>(image.at(x, y, c));
    }
  }
  return prior;
}

Eigen::MatrixXd solve(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& right) {
  const Eigen::CholmodSimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(lower);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::kInternal, "the normal equations of the colour fit cannot be factored");
  }
  return factor.solve(right);
}

/// For each pixel row, the function rows in it.
class RowIndex {
 public:
  struct Entry {
    spline::FunctionIndex function;
    const spline::GridValues::Row* row;
  };

  RowIndex(const spline::GridValues& grid, int begin, int end)
      : first_(begin), begin_(static_cast<std::size_t>(end - begin) + 1, 0) {
    for (const auto& r : grid.rows) ++begin_[static_cast<std::size_t>(r.y - first_) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(grid.rows.size());
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (spline::FunctionIndex f = 0; f + 1 < grid.row_begin.size(); ++f) {
      for (const auto& r : grid.rows_of(f))
        entries_[cursor[static_cast<std::size_t>(r.y - first_)]++] = {f, &r};
    }
  }

  std::span<const Entry> row(int y) const {
    const auto i = static_cast<std::size_t>(y - first_);
    return std::span(entries_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  int first_;
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
};

/// Picture minus surface.
void find_residual(const PixelValues& values, ColourFit& fit) {
  const image::Image& image = values.image();
  const auto channels = static_cast<std::size_t>(image.channels);
  fit.residual.resize(image.samples.size());
  std::vector<double> row_sums(static_cast<std::size_t>(image.height), 0.0);
  values.for_bands([&](const spline::GridValues& grid, int begin, int end) {
    const RowIndex index(grid, begin, end);
    parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
      const int y = begin + static_cast<int>(i);
      std::vector<double> row(image.row_size());
      for (int x = 0; x < image.width; ++x) {
        for (std::size_t c = 0; c < channels; ++c) {
          row[static_cast<std::size_t>(x) * channels + c] =
              values.root_weight(x, y) * static_cast<double>(image.at(x, y, static_cast<int>(c)));
        }
      }
      for (const RowIndex::Entry& e : index.row(y)) {
        const double* v = grid.values.data() + e.row->offset;
        const double* control = fit.control.data() + e.function * channels;
        for (std::int32_t x = e.row->x_begin; x < e.row->x_end; ++x, ++v) {
          double* at = row.data() + static_cast<std::size_t>(x) * channels;
          for (std::size_t c = 0; c < channels; ++c) at[c] -= *v * control[c];
        }
      }
      float* out = fit.residual.data() + static_cast<std::size_t>(y) * row.size();
      for (std::size_t k = 0; k < row.size(); ++k) {
        out[k] = static_cast<float>(row[k]);
        row_sums[static_cast<std::size_t>(y)] += row[k] * row[k];
      }
    });
  });
  fit.squared_error = std::accumulate(row_sums.begin(), row_sums.end(), 0.0);
}

}  // namespace

ColourFit fit_colours(const spline::Basis& basis, const Pixels& pixels, const ColourFitOptions& options) {
  const spline::SplineSpace& space = basis.space();
  const PixelValues values(basis, pixels);
  NormalEquations normal = assemble(values);
  const double ridge = options.ridge * std::max(1.0, normal.matrix.diagonal().maxCoeff());
  for (Eigen::Index i = 0; i < normal.matrix.rows(); ++i) normal.matrix.coeffRef(i, i) += ridge;

  // min |A c - b|^2 + ridge |c - prior|^2 over c = P z, with P the identity or the smooth surfaces.
  const Eigen::MatrixXd right = normal.right + ridge * greville_colours(space, *pixels.image);
  Eigen::MatrixXd control;
  if (options.smooth_corners) {
    const Eigen::SparseMatrix<double> p = spline::smooth_corner_prolongation(space);
    const Eigen::SparseMatrix<double> full = normal.matrix.selfadjointView<Eigen::Lower>();
    const Eigen::SparseMatrix<double> reduced = p.transpose() * full * p;
    control = p * solve(reduced.triangularView<Eigen::Lower>(), p.transpose() * right);
  } else {
    control = solve(normal.matrix, right);
  }
  ColourFit fit;
  fit.control.resize(static_cast<std::size_t>(control.size()));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      fit.control.data(), control.rows(), control.cols()) = control;
  find_residual(values, fit);
  return fit;
}

}  // namespace knotreel::fit
