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

/// Of a drawing in a group of drawings: as film it was tried in the first frame.
/// @param dense the group is. If not, the frame may be, if it would be poor otherwise.
std::shared_ptr<ColdFrame> make_drawn_frame(const image::Image& picture, const ColdOptions& options,
                                            bool dense, double colour_step);

}  // namespace knotreel::track
