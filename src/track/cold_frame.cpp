#include "track/cold_frame.h"

#include <chrono>

#include "track/residual.h"

namespace knotreel::track {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

std::shared_ptr<ColdFrame> make_cold_frame(const image::Image& picture, const vectorize::Options& options,
                                           const vectorize::Observer& observer) {
  const Clock::time_point start = Clock::now();
  vectorize::Vectorization made = vectorize::vectorize_picture(picture, options, observer);
  const auto frame = std::make_shared<ColdFrame>();
  frame->space = made.model.space;
  frame->displacement = std::move(made.model.displacement);
  frame->colours.control = std::move(made.model.colour);
  frame->milliseconds.emplace_back("cold", milliseconds_since(start));
  const Clock::time_point fitted = Clock::now();
  frame->basis = std::make_unique<const spline::Basis>(frame->space);
  frame->placed = place_pixels(*frame->basis, frame->displacement, picture);
  const fit::PixelValues values(*frame->basis, picture.width, picture.height, frame->placed.places);
  frame->colours.residual = residual_of(frame->placed.picture, values, frame->colours.control);
  frame->milliseconds.emplace_back("measure", milliseconds_since(fitted));
  return frame;
}

}  // namespace knotreel::track
