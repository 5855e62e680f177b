#include "knotreel/track/curve_error.h"

#include "track/snap.h"

namespace knotreel::track {

double curve_error(const document::FrameModel& model, const motion::Luma& picture) {
  if (model.space->mesh().segments.empty()) return 0;
  const spline::Basis basis(model.space);
  return mean_edge_distance(basis, model.displacement, picture);
}

}  // namespace knotreel::track
