// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/draft.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/squared_errors.h"

namespace knotreel::vectorize {

document::FrameModel Draft::model(int channels) const {
  document::FrameModel model;
  model.space = surface.space;
  model.displacement = displacement;
  model.channels = channels;
  model.colour = surface.fit.control;
  model.edge_softness = edge_softness;
  return model;
}

void fit_all_pixels(const spline::Basis& basis, const Samples& samples, const fit::ColourFitOptions& options,
                    Draft& draft, const fit::MixedPixels* mixed) {
  fit::Pixels pixels = samples.all();
  pixels.mixed = mixed;
  fit::ColourFitOptions from_last = options;
  from_last.start = draft.surface.fit.control;
  draft.surface.fit = fit::fit_colours(basis, pixels, from_last);
  draft.fits_all_pixels = true;
}

void fit_geometry(const spline::PixelValues& values, const Samples& samples,
                  const fit::GeometryFitOptions& options, Draft& draft) {
  if (!samples.has_features()) return;
  draft.displacement = fit::fit_geometry(values, samples.places(), samples.curves(), options);
  measure_curves(values.basis(), samples, draft);
}

void measure_curves(const spline::Basis& basis, const Samples& samples, Draft& draft) {
  draft.curve_errors = fit::geometry_errors(basis, draft.displacement, samples.curves());
  const double sum = std::accumulate(draft.curve_errors.begin(), draft.curve_errors.end(), 0.0);
  draft.meg = draft.curve_errors.empty() ? 0 : sum / static_cast<double>(draft.curve_errors.size());
}

void measure_colours(const Samples& samples, const Draft& draft, RoundReport& report) {
  const fit::Pixels pixels = draft.fits_all_pixels ? samples.all() : samples.steering();
  const std::span<const float> weights = pixels.weights;
  const auto channels = static_cast<std::size_t>(samples.picture().channels);
  const std::vector<float>& residual = draft.surface.fit.residual;
  const auto width = static_cast<std::size_t>(samples.picture().width);
  struct Row {
    double length = 0;
    double squared = 0;
    std::size_t count = 0;
  };
  std::vector<Row> rows(residual.size() / channels / width);
  parallel_for(rows.size(), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (!weights.empty() && weights[i] < 1) continue;
      const double squared = fit::squared_error<double>(*pixels.image, &residual[i * channels],
                                                        &pixels.image->samples[i * channels]);
      rows[y].length += std::sqrt(squared);
      rows[y].squared += squared;
      ++rows[y].count;
    }
  });
  double length = 0;
  double squared = 0;
  std::size_t count = 0;
  for (const Row& row : rows) {
    length += row.length;
    squared += row.squared;
    count += row.count;
  }
  if (count == 0) return;
  const auto sum = static_cast<double>(count * channels);
  report.mec = length / static_cast<double>(count);
  report.psnr = 10 * std::log10(255.0 * 255.0 * sum / squared);
}

std::vector<float> squared_errors(const Samples& samples, const Draft& draft) {
  const image::Image& picture = samples.picture();
  const image::Image& fitted = *(draft.fits_all_pixels ? samples.all() : samples.steering()).image;
  const auto channels = static_cast<std::size_t>(picture.channels);
  const auto width = static_cast<std::size_t>(picture.width);
  const std::size_t rows_per_row = draft.fits_all_pixels || !samples.steers_by_half_rows() ? 1 : 2;
  std::vector<float> squared(picture.pixel_count(), 0);
  parallel_for(squared.size() / width, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t from = y / rows_per_row * width + x;
      squared[y * width + x] = fit::squared_error<float>(fitted, &draft.surface.fit.residual[from * channels],
                                                         &fitted.samples[from * channels]);
    }
  });
  return squared;
}

}  // namespace knotreel::vectorize
