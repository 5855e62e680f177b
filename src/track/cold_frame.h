#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/fit/colour_fit.h"
#include "knotreel/spline/basis.h"
#include "knotreel/track/cold_frame.h"
#include "track/placed_pixels.h"

namespace knotreel::track {

struct ColdFrame {
  std::shared_ptr<const spline::SplineSpace> space;
  std::vector<Vec2> displacement;
  double edge_softness = 0;
  std::shared_ptr<const spline::Basis> basis;  ///< of space
  PlacedPixels placed;
  fit::ColourFit colours;                                    ///< the residual is that of placed
  std::shared_ptr<const spline::PixelSurface> surface;       ///< at placed
  std::vector<std::pair<std::string, double>> milliseconds;  ///< per stage, in order
};

}  // namespace knotreel::track
