// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/spline/space.h"

namespace knotreel::document {

inline constexpr double kMostEdgeSoftness = 0.25;
/// Documents have whole multiples of it.
inline constexpr double kEdgeSoftnessStep = 1.0 / 256;

/// One frame as a TCB-spline surface S(u) = sum B_I(u) c_I (paper Eq. 4): the spline space and the control
/// points, whose geometry part is stored as the displacement from the Greville site.
struct FrameModel {
  std::shared_ptr<const spline::SplineSpace> space;

  /// Geometry control point minus Greville site, in pixels, one per geometry group. All zero: the surface
  /// maps the parametric domain to the image by the identity.
  std::vector<Vec2> displacement;

  /// Number of colour channels: 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA (alpha is not premultiplied).
  int channels = 3;

  /// Colour control points, function by function, channels interleaved; scale 0..255, values beyond that
  /// range are normal. Gamma-encoded sRGB (or whatever the source was).
  std::vector<double> colour;

  /// Of a frame that is no keyframe: its colours are multiples of this, in levels, and are stored so; 0: in
  /// the steps of EncodeOptions. Filled in by Writer and Reader.
  double colour_step = 0;

  /// How soft edges are in the picture that the model was made from, 0 to kMostEdgeSoftness: pixels next to
  /// features are drawn through the filter (s, 1 - 2 s, s) along both axes. The surface itself jumps there.
  double edge_softness = 0;

  /// Names of the control points, function by function, unique within the frame: a control point of the same
  /// name in another frame of the group is the same one (docs/format.md, "Identities"). Filled in by Writer
  /// and Reader; Writer ignores what it is given.
  std::vector<std::uint32_t> function_ids;

  std::uint64_t frame = 0;  ///< index in the sequence, from 0
  std::int64_t pts = 0;     ///< presentation time stamp in units of the document's time base
  bool keyframe = true;     ///< stored and computed without a predecessor; starts a group
};

/// What keeps a model from being a surface that can be drawn: no space, other numbers of channels,
/// displacements or colours than it needs, or values that are not finite, or that no document could hold.
/// @return a one-line description of the first defect, such as "it has no spline space", or nothing.
std::optional<std::string> find_defect(const FrameModel& model);

/// Whether two models are one surface, drawn alike: they share the space, and have the same control points
/// and softness of edges. (Equal spaces that are not shared count as different: that is quick to tell.)
bool same_surface(const FrameModel& a, const FrameModel& b);

/// Storage by the accounting of the paper's Table 1: 20 bytes per control point, 8 per knot, 6 per triangle.
/// Multiple knots count once; the two or more functions along features count one control point each.
std::uint64_t raw_accounting_bytes(const FrameModel& model);

}  // namespace knotreel::document
