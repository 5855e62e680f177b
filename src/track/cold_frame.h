#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/track/cold_frame.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

struct ColdFrame {
  FittedFrame frame;
  std::vector<std::pair<std::string, double>> milliseconds;  ///< per stage, in order
};

/// With these options. @param is_drawn they are those of drawings.
std::shared_ptr<ColdFrame> cold_frame_with(const vectorize::Options& options, bool is_drawn,
                                           const image::Image& picture, double colour_step,
                                           const vectorize::Observer& observer);

}  // namespace knotreel::track
