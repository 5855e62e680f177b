// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/fitted_frame.h"

#include "knotreel/fit/squared_errors.h"

namespace knotreel::track {

document::FrameModel model_of(const FittedFrame& frame, int channels) {
  document::FrameModel model;
  model.space = frame.space;
  model.displacement = frame.displacement;
  model.channels = channels;
  model.colour = frame.colours.control;
  model.colour_step = frame.colour_step;
  model.edge_softness = frame.edge_softness;
  return model;
}

std::vector<float> squared_errors(const FittedFrame& frame) {
  return fit::squared_errors(frame.colours.residual, frame.seen.weights, frame.seen.picture);
}

}  // namespace knotreel::track
