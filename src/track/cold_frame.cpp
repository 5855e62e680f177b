#include "track/cold_frame.h"

#include <chrono>
#include <utility>

#include "knotreel/document/stored_mesh.h"

namespace knotreel::track {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

std::shared_ptr<ColdFrame> make_cold_frame(const image::Image& picture, const vectorize::Options& options,
                                           double colour_step, const vectorize::Observer& observer) {
  const Clock::time_point start = Clock::now();
  vectorize::Vectorization made = vectorize::vectorize_picture(picture, options, observer);
  const auto cold = std::make_shared<ColdFrame>();
  FittedFrame& frame = cold->frame;
  frame.limits = {made.report.feature_share, made.report.chains_over_budget > 0,
                  made.report.strong_over_budget};
  frame.space = made.model.space;
  frame.displacement = std::move(made.model.displacement);
  frame.edge_softness = made.model.edge_softness;
  frame.colour_step = colour_step;
  frame.colours.control = std::move(made.model.colour);
  document::round_colours(frame.colours.control, colour_step);
  cold->milliseconds.emplace_back("cold", milliseconds_since(start));
  const Clock::time_point fitted = Clock::now();
  frame.basis = std::move(made.fitted.basis);
  frame.seen = placed_pixels(picture,
                             std::make_shared<const spline::PlacedBasis>(
                                 frame.basis, picture.width, picture.height, std::move(made.fitted.places)),
                             made.fitted.crossed, 0);  // it was not fitted to a sharpened picture
  frame.surface = surface_at(frame.seen, frame.colours.control);
  frame.colours.residual = residual_of(frame.seen, *frame.surface);
  cold->milliseconds.emplace_back("measure", milliseconds_since(fitted));
  return cold;
}

}  // namespace knotreel::track
