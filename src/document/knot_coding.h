#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "document/conquest.h"
#include "document/frame_state.h"
#include "document/identity.h"
#include "document/residual_coding.h"

/// Knot positions as differences from predictions (docs/format.md, "Positions").
namespace knotreel::document {

/// What the coding of positions knows beforehand. The mesh may have topological defects.
struct KnotLayout {
  const mesh::KnotMesh& mesh;  ///< canonical, kinds and segments set; positions are not used
  const std::vector<Discovery>& discoveries;
  KnotIndex border_count;
  std::array<KnotIndex, 4> domain_corners;

  /// Side of the domain (0 top, 1 right, 2 bottom, 3 left) of a border knot other than the corners.
  int side(KnotIndex k) const {
    int s = 3;
    while (s > 0 && k < domain_corners[static_cast<std::size_t>(s)]) --s;
    return s;
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

 private:
  std::int64_t scaled(std::int64_t v) const {
    if (shift_ >= 0) return v * (std::int64_t{1} << shift_);
    return (v + (std::int64_t{1} << -shift_) / 2) >> -shift_;
  }

  const FrameState* before_;
  const std::vector<std::uint32_t>& matches_;
  int shift_;
};

template <class Coder>
class KnotCoding {
 public:
  KnotCoding(Coder& coder, PositionModels& models, const KnotLayout& layout, const PreviousKnots& previous,
             KnotGrid& grid)
      : coder_(coder),
        models_(models),
        layout_(layout),
        previous_(previous),
        grid_(grid),
        width_(static_cast<std::int64_t>(layout.mesh.width) << grid.bits),
        height_(static_cast<std::int64_t>(layout.mesh.height) << grid.bits) {}

  void run() {
    border();
    vertices();
    segments();
    free_knots();
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
        require_inside(grid_.points[k]);
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
      require_inside(p);
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

  void free_knots() {
    const std::size_t inside = layout_.discoveries.size();
    moves_.assign(layout_.border_count + inside, {});
    for (KnotIndex k = 0; k < layout_.mesh.knots.size(); ++k) {
      if (layout_.mesh.knots[k].kind != KnotKind::kFree && previous_.matched(k)) set_move(k);
    }
    sizes_.resize(moves_.size());
    for (KnotIndex k = layout_.border_count; k < layout_.mesh.knots.size(); ++k) {
      if (layout_.mesh.knots[k].kind != KnotKind::kFree) continue;
      const Discovery& d = layout_.discoveries[k - layout_.border_count];
      const auto* match = previous_.match(k, KnotKind::kFree);
      const GridPoint prediction = match ? carried(previous_.point(*match), d) : across(d);
      Around around_x;
      Around around_y;
      for (const KnotIndex gate : {d.a, d.b, d.behind}) {
        if (gate == kNoKnot) continue;
        around_x.add(sizes_[gate][0]);
        around_y.add(sizes_[gate][1]);
      }
      GridPoint& p = grid_.points[k];
      auto& models = models_.free[match ? 1 : 0];
      const std::int64_t x = code_residual(coder_, models[0], around_x, p.x, prediction.x);
      around_y.size += x < 0 ? -x : x;
      ++around_y.count;
      const std::int64_t y = code_residual(coder_, models[1], around_y, p.y, prediction.y);
      require_inside(p);
      if (match) {
        sizes_[k][0].add(x);
        sizes_[k][1].add(y);
        set_move(k);
      }
    }
  }

  static Around latest(std::int64_t difference) {
    Around around;
    around.add(difference);
    return around;
  }

  /// How a knot has moved since the frame before.
  struct Move {
    bool known = false;
    std::int64_t x = 0;
    std::int64_t y = 0;
  };

  void set_move(KnotIndex k) {
    const GridPoint before = previous_.point(previous_.matched_index(k));
    moves_[k] = {true, grid_.points[k].x - before.x, grid_.points[k].y - before.y};
  }

  /// A place moved like the knots around the gate.
  GridPoint carried(GridPoint p, const Discovery& d) const {
    Move sum;
    std::int64_t count = 0;
    for (const KnotIndex k : {d.a, d.b, d.behind}) {
      if (k == kNoKnot || !moves_[k].known) continue;
      sum.x += moves_[k].x;
      sum.y += moves_[k].y;
      ++count;
    }
    if (count == 0) return p;
    return clamped(
        {p.x + floor_div(2 * sum.x + count, 2 * count), p.y + floor_div(2 * sum.y + count, 2 * count)});
  }

  /// The fourth corner of a parallelogram over the gate; at the border, that of an equilateral triangle,
  /// nearly.
  GridPoint across(const Discovery& d) const {
    const GridPoint a = grid_.points[d.a];
    const GridPoint b = grid_.points[d.b];
    if (d.behind != kNoKnot) {
      const GridPoint p = grid_.points[d.behind];
      return clamped({a.x + b.x - p.x, a.y + b.y - p.y});
    }
    return clamped(
        {((a.x + b.x) >> 1) - ((7 * (b.y - a.y)) >> 3), ((a.y + b.y) >> 1) + ((7 * (b.x - a.x)) >> 3)});
  }

  GridPoint clamped(GridPoint p) const {
    return {std::clamp<std::int64_t>(p.x, 0, width_), std::clamp<std::int64_t>(p.y, 0, height_)};
  }
  void require_inside(GridPoint p) const {
    if (!(clamped(p) == p)) malformed("a knot lies outside the domain");
  }

  Coder& coder_;
  PositionModels& models_;
  const KnotLayout& layout_;
  const PreviousKnots& previous_;
  KnotGrid& grid_;
  std::int64_t width_;
  std::int64_t height_;
  std::vector<Move> moves_;                   ///< by knot
  std::vector<std::array<Around, 2>> sizes_;  ///< by free knot: its differences in x and y
};

}  // namespace knotreel::document
