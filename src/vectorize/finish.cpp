// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/finish.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/fit/pixel_places.h"
#include "knotreel/fit/squared_errors.h"
#include "knotreel/raster/edge_softness.h"
#include "vectorize/mixed_pixels.h"

namespace knotreel::vectorize {

namespace {

// In place of Options::unfold, where the geometry is not to stay.
constexpr double kQuickUnfold = 0.7;

using BasisPointer = std::shared_ptr<const spline::Basis>;

/// Goes over to the space as documents have it.
void store_space(int knot_bits, std::size_t channels, fit::ColourSurface& surface) {
  const document::StoredSpace stored = document::stored_space(surface.space, knot_bits);
  std::vector<double> control;
  control.reserve(stored.function_of.size() * channels);
  for (const spline::FunctionIndex f : stored.function_of) {
    for (std::size_t c = 0; c < channels; ++c) control.push_back(surface.fit.control[f * channels + c]);
  }
  surface.space = stored.space;
  surface.fit.control = std::move(control);
}

/// The last geometry, and the samples where it puts them. @return the pixels that features cross.
std::vector<std::uint8_t> finish_geometry(const spline::Basis& basis, const Options& options,
                                          Samples& samples, RunLog& log, Draft& draft) {
  const int width = samples.picture().width, height = samples.picture().height;
  std::optional<spline::PixelValues> values;
  parallel_invoke([&] { values.emplace(basis, width, height, samples.places()); }, [&] { basis.index(); });
  log.lap("basis");
  fit_geometry(*values, samples, options.geometry, draft);
  log.lap("geometry");
  document::round_displacement(draft.displacement, options.displacement_step);
  log.report.geometry_folds = fit::unfold_geometry(basis, draft.displacement, options.unfold);
  document::round_displacement(draft.displacement, options.displacement_step);
  measure_curves(basis, samples, draft);
  log.lap("unfold");
  std::vector<std::uint8_t> crossed = fit::crossed_pixels(basis, draft.displacement, width, height);
  samples.move(fit::pixel_places(basis, draft.displacement, width, height), crossed,
               draft.surface.space->mesh());
  log.lap("invert");
  return crossed;
}

/// The last geometry, and the colours of all pixels where it puts them. @return the pixels that features
/// cross.
std::vector<std::uint8_t> fit_as_drawn(const BasisPointer& basis, const Options& options, Samples& samples,
                                       RunLog& log, Draft& draft) {
  std::vector<std::uint8_t> crossed;
  if (samples.has_features()) crossed = finish_geometry(*basis, options, samples, log, draft);
  fit::MixedPixels mixed;
  if (samples.has_features() && options.mixed_weight > 0) {
    const image::Image& picture = samples.picture();
    mixed = mixed_pixels(draft.model(picture.channels), basis, picture, options.mixed_weight);
    log.lap("mixed");
  }
  fit_all_pixels(*basis, samples, options.colour, draft, &mixed);
  log.lap("colours");
  return crossed;
}

double fitting_edge_softness(const BasisPointer& basis, const Samples& samples, const Draft& draft) {
  auto surface = std::make_shared<spline::PixelSurface>();
  surface->basis = basis;
  surface->colours.resize(samples.colours().samples.size());
  std::transform(samples.colours().samples.begin(), samples.colours().samples.end(),
                 draft.surface.fit.residual.begin(), surface->colours.begin(), std::minus());
  return raster::fitting_edge_softness(draft.model(samples.picture().channels), samples.picture(), basis,
                                       std::move(surface));
}

}  // namespace

Outlook outlook(const Options& options, Samples& samples, RunLog& log, const Draft& draft) {
  Draft trial;
  trial.surface = draft.surface;
  Options quick = options;
  quick.unfold = std::min(options.unfold, kQuickUnfold);
  Samples::State before = samples.state();
  fit_as_drawn(std::make_shared<const spline::Basis>(trial.surface.space), quick, samples, log, trial);
  RoundReport report;
  measure_colours(samples, trial, report);
  Outlook result{fit::squared_errors(trial.surface.fit.residual, samples.weights(), samples.picture()),
                 report.mec};
  samples.restore(std::move(before));
  return result;
}

Fitted finish(const Options& options, Samples& samples, RunLog& log, Draft& draft) {
  store_space(options.knot_bits, static_cast<std::size_t>(samples.picture().channels), draft.surface);
  const auto basis = std::make_shared<const spline::Basis>(draft.surface.space);
  std::vector<std::uint8_t> crossed = fit_as_drawn(basis, options, samples, log, draft);
  if (samples.has_features()) {
    draft.edge_softness = fitting_edge_softness(basis, samples, draft);
    log.lap("softness");
  }
  return {basis, samples.take_places(), std::move(crossed)};
}

}  // namespace knotreel::vectorize
