#pragma once

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

}  // namespace knotreel::track
