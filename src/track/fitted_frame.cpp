#include "track/fitted_frame.h"

#include "knotreel/fit/squared_errors.h"

namespace knotreel::track {

std::vector<float> squared_errors(const FittedFrame& frame) {
  return fit::squared_errors(frame.colours.residual, frame.seen.weights, frame.seen.picture);
}

}  // namespace knotreel::track
