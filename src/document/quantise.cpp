// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/quantise.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/document/stored_mesh.h"

namespace knotreel::document {
namespace {

/// Keeps the parameters of one segment strictly increasing within (0, kSegmentUnit).
void spread(std::vector<std::int64_t>& parameters) {
  const auto n = static_cast<std::int64_t>(parameters.size());
  if (n >= kSegmentUnit) throw Error(ErrorKind::kInvalidArgument, "too many knots on one feature segment");
  std::int64_t last = 0;
  for (std::int64_t& p : parameters) last = p = std::max(p, last + 1);
  std::int64_t next = kSegmentUnit;
  for (auto p = parameters.rbegin(); p != parameters.rend(); ++p) next = *p = std::min(*p, next - 1);
}

KnotGrid snap(const mesh::KnotMesh& mesh, int bits) {
  KnotGrid grid;
  grid.bits = bits;
  grid.points.resize(mesh.knots.size());
  grid.parameters.assign(mesh.knots.size(), 0);
  const double scale = std::ldexp(1.0, bits);
  const auto width = std::llround(mesh.width * scale);
  const auto height = std::llround(mesh.height * scale);
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    const Vec2 p = mesh.knots[k].position;
    grid.points[k] = {std::clamp<std::int64_t>(std::llround(p.x * scale), 0, width),
                      std::clamp<std::int64_t>(std::llround(p.y * scale), 0, height)};
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 d = mesh.knots[s.knots.back()].position - a;
    std::vector<std::int64_t> parameters;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      const double t = dot(mesh.knots[s.knots[i]].position - a, d) / dot(d, d);
      parameters.push_back(std::llround(std::clamp(t, 0.0, 1.0) * static_cast<double>(kSegmentUnit)));
    }
    spread(parameters);
    for (std::size_t i = 0; i < parameters.size(); ++i) grid.parameters[s.knots[i + 1]] = parameters[i];
  }
  return grid;
}

}  // namespace

KnotGrid quantise_knots(CanonicalMesh& numbering, int least_bits) {
  if (least_bits < kMinKnotBits || least_bits > kMaxKnotBits)
    throw Error(ErrorKind::kInvalidArgument, "the knot bits of a document are 0 to 14");
  mesh::KnotMesh& mesh = numbering.mesh;
  for (const mesh::Knot& k : mesh.knots) {
    if (!std::isfinite(k.position.x) || !std::isfinite(k.position.y)) {
      throw Error(ErrorKind::kInvalidArgument, "cannot store a frame: a knot has no finite position");
    }
  }
  // A grid that was too coarse for the given positions may do for the snapped ones, so snap until it stays:
  // then a document read and written again keeps its bytes. The grid can only become coarser, so this ends.
  std::vector<mesh::Knot> before = mesh.knots;
  int previous_bits = -1;
  std::optional<std::string> defect;
  for (int bits = least_bits; bits <= kMaxKnotBits; ++bits) {
    const KnotGrid grid = snap(mesh, bits);
    set_positions(mesh, grid);
    if ((defect = mesh::find_geometric_defect(mesh))) {
      mesh.knots = before;
      continue;
    }
    if (bits == least_bits || bits == previous_bits) return grid;
    previous_bits = bits;
    before = mesh.knots;
    bits = least_bits - 1;
  }
  throw FlatFace("cannot store a frame: on the finest grid, 2^-" + std::to_string(kMaxKnotBits) + " px, " +
                 *defect);
}

std::int64_t quantise(double value, double step, const char* what) {
  const double q = value / step;
  // Colours are stored as multiples of a unit, which must not lead beyond the bound.
  if (!(std::abs(q) < static_cast<double>(kMaxControl / kMaxColourUnit))) {
    throw Error(ErrorKind::kInvalidArgument,
                std::string("cannot store a frame: a ") + what + " is out of range");
  }
  return std::llround(q);
}

}  // namespace knotreel::document
