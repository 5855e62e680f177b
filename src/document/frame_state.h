// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "document/conquest.h"
#include "document/frame_models.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/document/limits.h"
#include "knotreel/document/sequence_info.h"
#include "knotreel/spline/space.h"

namespace knotreel::document {

using mesh::KnotId;
using mesh::KnotIndex;
using mesh::KnotKind;

inline constexpr std::int64_t kMaxColourUnit = 255;
inline constexpr std::int64_t kSegmentUnit = 65536;  ///< the whole length of a feature segment
inline constexpr double kColourUnits = 512;          ///< per level: resolution of the colour step
inline constexpr double kDisplacementUnits = 4096;   ///< per pixel: resolution of the displacement step
inline constexpr std::int64_t kMaxControl = std::int64_t{1} << 31;  ///< bound of quantised control values

/// What the header chunk says: how to read the integers of all frames.
struct Format {
  SequenceInfo info;
  std::uint32_t colour_step = 0;        ///< in 1/512 level, 1 to 65535
  std::uint32_t displacement_step = 0;  ///< in 1/4096 px, 1 to 65535

  double colour_scale() const { return colour_step / kColourUnits; }
  double displacement_scale() const { return displacement_step / kDisplacementUnits; }
};

/// A point in units of 2^-knot_bits px.
struct GridPoint {
  std::int64_t x = 0;
  std::int64_t y = 0;

  friend bool operator==(GridPoint, GridPoint) = default;
};

/// The integers behind the knots of one frame, in canonical order.
struct KnotGrid {
  int bits = 0;
  std::vector<GridPoint> points;         ///< of kSegment knots rounded, and only for prediction
  std::vector<std::int64_t> parameters;  ///< of kSegment knots: place on the segment in 1/65536, else 0
};

/// What the next frame of the group may be expected from besides the frame itself. Not part of the picture.
struct FrameHistory {
  std::vector<std::int64_t> areas;   ///< by function, see polygon_areas()
  std::vector<std::int8_t> changes;  ///< `channels` per function: the difference coded, clamped; 0 if new
  std::vector<std::uint8_t> stays;   ///< by knot: bit i says that it stayed i frames ago, of the last four
};

/// A frame as the file has it, in integers and canonical order, together with what follows from it.
struct FrameState {
  std::uint64_t frame = 0;
  std::int64_t pts = 0;
  bool keyframe = true;

  std::array<KnotIndex, 4> domain_corners{};  ///< top left (always 0), top right, bottom right, bottom left
  KnotIndex border_count = 0;                 ///< knots on the border come first
  std::vector<Discovery> discoveries;         ///< of the knots inside, for prediction
  KnotGrid grid;
  std::shared_ptr<const spline::SplineSpace> space;
  std::vector<std::int64_t> displacement;  ///< two per geometry group, in steps
  std::int64_t colour_unit = 1;            ///< all colours are multiples of this
  std::vector<std::int64_t> colour;        ///< `channels` per function, in steps
  std::uint8_t edge_softness = 0;          ///< in kEdgeSoftnessStep
  std::vector<std::uint32_t> function_ids;
  std::uint32_t next_function_id = 0;  ///< of the group, so far
  FrameModels models;                  ///< of the group, after this frame
  FrameHistory history;

  const mesh::KnotMesh& mesh() const { return space->mesh(); }
};

/// The frame in pixels and levels.
FrameModel to_model(const FrameState& state, const Format& format);

/// A point of a grid in 1/16 px, towards minus infinity.
GridPoint in_sixteenths(GridPoint p, int bits);

/// Twice the areas of the polygons that the functions belong to (docs/format.md, "Colours of other frames"),
/// in 1/256 px^2.
std::vector<std::int64_t> polygon_areas(const spline::SplineSpace& space, const KnotGrid& grid);

/// Kinds from the topology: on the border kVertex for domain corners and ends of segments, else kBorder;
/// inside kVertex for ends of segments, kSegment inside segments, else kFree.
void set_kinds(mesh::KnotMesh& mesh, KnotIndex border_count, const std::array<KnotIndex, 4>& domain_corners);

/// Positions from the grid. @pre kinds and segments are set, indices valid.
void set_positions(mesh::KnotMesh& mesh, const KnotGrid& grid);

}  // namespace knotreel::document
