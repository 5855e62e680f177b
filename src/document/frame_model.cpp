// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/frame_model.h"

#include <algorithm>
#include <cmath>

namespace knotreel::document {
namespace {

/// Control values of documents are 32 bits times a step of less than 2^8.
constexpr double kLargest = 0x1p40;

bool is_in_range(double value) {
  return std::abs(value) <= kLargest;  // not, if it is no number
}

}  // namespace

std::optional<std::string> find_defect(const FrameModel& model) {
  if (!model.space) return "it has no spline space";
  if (model.channels < 1 || model.channels > 4) return "it has no channels, or more than four";
  if (model.displacement.size() != model.space->geometry_count())
    return "it has too few or too many displacements";
  if (model.colour.size() != model.space->function_count() * static_cast<std::size_t>(model.channels))
    return "it has too few or too many control colours";
  if (!std::all_of(model.displacement.begin(), model.displacement.end(),
                   [](Vec2 d) { return is_in_range(d.x) && is_in_range(d.y); }))
    return "a displacement is out of range";
  if (!std::all_of(model.colour.begin(), model.colour.end(), is_in_range))
    return "a control colour is out of range";
  if (!(model.edge_softness >= 0 && model.edge_softness <= kMostEdgeSoftness))
    return "the softness of its edges is out of range";
  return {};
}

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
