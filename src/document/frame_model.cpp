#include "knotreel/document/frame_model.h"

namespace knotreel::document {

bool same_surface(const FrameModel& a, const FrameModel& b) {
  return a.space == b.space && a.channels == b.channels && a.edge_softness == b.edge_softness &&
         a.displacement == b.displacement && a.colour == b.colour;
}

std::uint64_t raw_accounting_bytes(const FrameModel& model) {
  const auto& mesh = model.space->mesh();
  return 20 * std::uint64_t{model.space->function_count()} + 8 * std::uint64_t{mesh.knots.size()} +
         6 * std::uint64_t{mesh.faces.size()};
}

}  // namespace knotreel::document
