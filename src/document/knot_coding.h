// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "document/free_knot_coding.h"
#include "document/knot_layout.h"
#include "document/residual_coding.h"

/// Knot positions as differences from predictions (docs/format.md, "Positions").
namespace knotreel::document {

template <class Coder>
class KnotCoding {
 public:
  KnotCoding(Coder& coder, PositionModels& models, const KnotLayout& layout, const PreviousKnots& previous,
             KnotGrid& grid, std::vector<std::uint8_t>& stays)
      : coder_(coder),
        models_(models),
        layout_(layout),
        previous_(previous),
        grid_(grid),
        stays_(stays),
        width_(static_cast<std::int64_t>(layout.mesh.width) << grid.bits),
        height_(static_cast<std::int64_t>(layout.mesh.height) << grid.bits) {}

  void run() {
    border();
    vertices();
    segments();
    FreeKnotCoding(coder_, models_, layout_, previous_, grid_, stays_).run();
  }

 private:
  std::int64_t along(int side, GridPoint p) const {
    return side == 0 ? p.x : side == 1 ? p.y : side == 2 ? width_ - p.x : height_ - p.y;
  }
  GridPoint on_side(int side, std::int64_t s) const {
    switch (side) {
      case 0:
        return {s, 0};
      case 1:
        return {width_, s};
      case 2:
        return {width_ - s, height_};
      default:
        return {0, height_ - s};
    }
  }

  void border() {
    Around around;
    for (int side = 0; side < 4; ++side) {
      const auto i = static_cast<std::size_t>(side);
      const KnotIndex first = layout_.domain_corners[i];
      const KnotIndex end = side == 3 ? layout_.border_count : layout_.domain_corners[i + 1];
      const std::int64_t length = side % 2 == 0 ? width_ : height_;
      grid_.points[first] = on_side(side, 0);
      std::int64_t last = 0;
      for (KnotIndex k = first + 1; k < end; ++k) {
        std::int64_t s = along(side, grid_.points[k]);
        std::int64_t prediction = last + (length - last) / (end - k + 1);
        bool old = false;
        if (const auto* match = previous_.match(k, KnotKind::kBorder)) {
          // A knot that left its side is taken for new.
          const GridPoint before = previous_.point(*match);
          const std::int64_t t = along(side, before);
          if (before == on_side(side, t)) {
            prediction = t;
            old = true;
          }
        }
        around = latest(code_residual(coder_, models_.border[old ? 1 : 0], around, s, prediction));
        last = s;
        grid_.points[k] = on_side(side, s);
        layout_.require_inside(grid_.points[k], grid_.bits);
      }
    }
  }

  void vertices() {
    // The first vertex of a polyline predicts the next one along it.
    std::vector<KnotIndex> neighbour(layout_.mesh.knots.size(), kNoKnot);
    for (const mesh::FeatureSegment& s : layout_.mesh.segments) {
      if (neighbour[s.knots.back()] == kNoKnot) neighbour[s.knots.back()] = s.knots.front();
    }
    GridPoint last{width_ / 2, height_ / 2};
    Around around;
    for (KnotIndex k = layout_.border_count; k < layout_.mesh.knots.size(); ++k) {
      if (layout_.mesh.knots[k].kind != KnotKind::kVertex) continue;
      GridPoint prediction = neighbour[k] != kNoKnot ? grid_.points[neighbour[k]] : last;
      const auto* match = previous_.match(k, KnotKind::kVertex);
      if (match) prediction = previous_.point(*match);
      GridPoint& p = grid_.points[k];
      ResidualModels& models = models_.vertex[match ? 1 : 0];
      around = latest(code_residual(coder_, models, around, p.x, prediction.x));
      around = latest(code_residual(coder_, models, around, p.y, prediction.y));
      layout_.require_inside(p, grid_.bits);
      last = p;
    }
  }

  void segments() {
    Around around;
    for (const mesh::FeatureSegment& s : layout_.mesh.segments) {
      const GridPoint a = grid_.points[s.knots.front()];
      const GridPoint b = grid_.points[s.knots.back()];
      std::int64_t last = 0;
      for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
        const KnotIndex k = s.knots[i];
        const auto left = static_cast<std::int64_t>(s.knots.size() - i);
        std::int64_t prediction = last + (kSegmentUnit - last) / left;
        const auto* match = previous_.match(k, KnotKind::kSegment);
        if (match) prediction = previous_.parameter(*match);
        std::int64_t& t = grid_.parameters[k];
        around = latest(code_residual(coder_, models_.parameter[match ? 1 : 0], around, t, prediction));
        if (t <= last || t >= kSegmentUnit) malformed("the knots of a segment are out of order");
        last = t;
        grid_.points[k] = {a.x + ((t * (b.x - a.x)) >> 16), a.y + ((t * (b.y - a.y)) >> 16)};
      }
    }
  }

  static Around latest(std::int64_t difference) {
    Around around;
    around.add(difference);
    return around;
  }

  Coder& coder_;
  PositionModels& models_;
  const KnotLayout& layout_;
  const PreviousKnots& previous_;
  KnotGrid& grid_;
  std::vector<std::uint8_t>& stays_;  ///< of the frame's history
  std::int64_t width_;
  std::int64_t height_;
};

}  // namespace knotreel::document
