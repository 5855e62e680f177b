// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/warm_fit.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/tiles_around.h"
#include "knotreel/base/parallel.h"
#include "track/kept.h"
#include "track/local_error.h"
#include "track/matching.h"
#include "track/temporal_target.h"
#include "vectorize/mixed_pixels.h"

namespace knotreel::track {

namespace {

constexpr std::size_t kTilesOfMixed = 1;  // from those that are fitted to mixed pixels with places in them
constexpr int kFitsToSettle = 2;  // of the same colours at the same places, before a control point stays

/// By function: 1 for those whose colour has found its place, and stays; or none.
std::vector<std::uint8_t> settled_functions(const FittedFrame& before, const FittedFrame& frame) {
  std::vector<std::uint8_t> settled;
  if (before.prints.empty() || frame.prints.empty() || frame.colour_step != before.colour_step)
    return settled;
  settled.reserve(frame.ages.size());
  for (const std::uint8_t age : frame.ages) settled.push_back(age >= kFitsToSettle ? 1 : 0);
  return settled;
}

/// By tile of 8x8 pixels: 1 where there are functions that are not settled; or none: everywhere.
std::vector<std::uint8_t> tiles_to_fit(const spline::PixelValues& values,
                                       const std::vector<std::uint8_t>& settled) {
  std::vector<std::uint8_t> tiles;
  if (settled.empty()) return tiles;
  tiles.reserve(values.tile_count());
  for (std::size_t t = 0; t < values.tile_count(); ++t) {
    const auto functions = values.functions(t);
    const bool any =
        std::any_of(functions.begin(), functions.end(), [&](spline::FunctionIndex f) { return !settled[f]; });
    tiles.push_back(any ? 1 : 0);
  }
  return tiles;
}

/// Colours of control points in the frame before; NaN for those that were not there.
std::vector<double> colours_before(const FittedFrame& before, std::span<const std::uint32_t> match) {
  const std::vector<double>& control = before.colours.control;
  const std::size_t channels = control.size() / before.space->function_count();
  std::vector<double> colours(match.size() * channels, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t f = 0; f < match.size(); ++f) {
    if (match[f] == kNoMatch) continue;
    std::copy_n(control.begin() + static_cast<std::ptrdiff_t>(match[f] * channels), channels,
                colours.begin() + static_cast<std::ptrdiff_t>(f * channels));
  }
  return colours;
}

/// By function. What is hit well shows what is left over from the frame before, and has little to flicker.
std::vector<double> reluctance_to_change(const FittedFrame& before, const FittedFrame& frame,
                                         const TrackOptions& options) {
  const image::Image& picture = frame.seen.picture;
  std::vector<double> result =
      local_errors(*frame.space, before.colours.residual, picture.width, picture.height, picture.channels);
  for (double& r : result) r = options.reluctance * std::min(1.0, r / options.reluctance_error);
  return result;
}

}  // namespace

void fit_warm_frame(const FittedFrame& before, const WarmFit& how, FittedFrame& frame, Laps& laps) {
  Kept kept(before, frame, how.match);
  frame.seen = place_pixels(frame.basis, frame.displacement, how.picture, frame.edge_softness, kept.places());
  kept.see();
  frame.ages = kept.ages();
  const std::vector<std::uint8_t> settled = settled_functions(before, frame);
  const std::vector<std::uint8_t> tiles = tiles_to_fit(frame.values(), settled);
  fit::MixedPixels mixed;
  const bool has_mixed = how.mixed_weight > 0 && !frame.space->mesh().segments.empty();
  if (has_mixed)
    mixed = vectorize::mixed_pixels(model_of(frame, how.picture.channels), frame.basis, how.picture,
                                    how.mixed_weight,
                                    tiles_around(tiles, frame.values().tile_columns(), kTilesOfMixed));
  laps.lap("places");
  const image::Image wanted =
      temporal_target(frame.seen.picture, before.colours.residual, before.seen.weights, how.motion,
                      how.options.temporal_weight, tiles);
  fit::Pixels pixels = frame.seen.view();
  pixels.image = &wanted;
  if (has_mixed) pixels.mixed = &mixed;
  const std::vector<double> start = colours_before(before, how.match);
  const std::vector<double> reluctance = reluctance_to_change(before, frame, how.options);
  fit::ColourFitOptions colour = how.colour;
  colour.find_residual = false;
  colour.start = start;
  colour.step = frame.colour_step;
  colour.reluctance = reluctance;
  colour.fixed = settled;
  frame.colours = fit::fit_colours(frame.values(), pixels, colour);
  frame.same = kept.surface(frame.colours.control);
  frame.surface = surface_at(frame.seen, frame.colours.control, frame.same, before.surface.get());
  frame.colours.residual = residual_of(frame.seen, *frame.surface);
  laps.lap("colours");
}

}  // namespace knotreel::track
