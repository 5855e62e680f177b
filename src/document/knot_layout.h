// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "document/bytes.h"
#include "document/conquest.h"
#include "document/frame_state.h"
#include "document/identity.h"

/// What the coding of knot positions knows of this frame and the one before.
namespace knotreel::document {

/// What the coding of positions knows beforehand. The mesh may have topological defects.
struct KnotLayout {
  const mesh::KnotMesh& mesh;  ///< canonical, kinds and segments set; positions are not used
  const std::vector<Discovery>& discoveries;
  KnotIndex border_count;
  std::array<KnotIndex, 4> domain_corners;

  /// The nearest point of the domain on a grid of 2^-bits px.
  GridPoint clamped(GridPoint p, int bits) const {
    return {std::clamp<std::int64_t>(p.x, 0, static_cast<std::int64_t>(mesh.width) << bits),
            std::clamp<std::int64_t>(p.y, 0, static_cast<std::int64_t>(mesh.height) << bits)};
  }
  /// @throws Malformed
  void require_inside(GridPoint p, int bits) const {
    if (!(clamped(p, bits) == p)) malformed("a knot lies outside the domain");
  }
};

/// The frame before, seen from this one.
class PreviousKnots {
 public:
  /// @param before  null for a keyframe. @param matches  of the knots of this frame.
  PreviousKnots(const FrameState* before, const std::vector<std::uint32_t>& matches, int bits)
      : before_(before), matches_(matches), shift_(before ? bits - before->grid.bits : 0) {}

  /// The same knot in the frame before, or null if it is new or of another kind. Free knots and vertices are
  /// of one kind here.
  const std::uint32_t* match(KnotIndex k, KnotKind kind) const {
    if (!before_ || matches_[k] == kNoMatch) return nullptr;
    const bool was_segment = before_->mesh().knots[matches_[k]].kind == KnotKind::kSegment;
    return was_segment == (kind == KnotKind::kSegment) ? &matches_[k] : nullptr;
  }
  bool matched(KnotIndex k) const { return before_ && matches_[k] != kNoMatch; }
  std::uint32_t matched_index(KnotIndex k) const { return matches_[k]; }
  /// Its place on today's grid.
  GridPoint point(std::uint32_t match) const {
    const GridPoint p = before_->grid.points[match];
    return {scaled(p.x), scaled(p.y)};
  }
  std::int64_t parameter(std::uint32_t match) const { return before_->grid.parameters[match]; }
  /// Whether there is a frame before.
  bool any() const { return before_ != nullptr; }
  std::uint8_t stays(std::uint32_t match) const { return before_->history.stays[match]; }

 private:
  std::int64_t scaled(std::int64_t v) const {
    if (shift_ >= 0) return v * (std::int64_t{1} << shift_);
    return (v + (std::int64_t{1} << -shift_) / 2) >> -shift_;
  }

  const FrameState* before_;
  const std::vector<std::uint32_t>& matches_;
  int shift_;
};

}  // namespace knotreel::document
