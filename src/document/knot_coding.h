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
    stays_.assign(layout_.mesh.knots.size(), 0);
    for (KnotIndex k = layout_.border_count; k < layout_.mesh.knots.size(); ++k) {
      if (layout_.mesh.knots[k].kind == KnotKind::kFree) free_knot(k);
    }
  }

  void free_knot(KnotIndex k) {
    const Discovery& d = layout_.discoveries[k - layout_.border_count];
    const auto* match = previous_.match(k, KnotKind::kFree);
    const GridPoint was = match ? previous_.point(*match) : GridPoint{};
    const GridPoint prediction = match ? carried(was, d) : across(d);
    GridPoint& p = grid_.points[k];
    const GridPoint expected = match ? GridPoint{prediction.x - was.x, prediction.y - was.y} : GridPoint{};
    const std::size_t moved = around_moved(d);
    bool stays = false;
    if (match) {
      const std::uint8_t history = previous_.stays(*match);
      stays = coder_.bit(stay_model(history, moved, expected), p == was);
      if (stays) p = was;
      stays_[k] = static_cast<std::uint8_t>(((history << 1) | (stays ? 1 : 0)) & 15);
    }
    if (!stays) code_free(d, match != nullptr, moved, expected, prediction, p);
    require_inside(p);
    if (match) {
      sizes_[k][0].add(p.x - prediction.x);
      sizes_[k][1].add(p.y - prediction.y);
      set_move(k);
    }
  }

  void code_free(const Discovery& d, bool old, std::size_t moved, GridPoint expected, GridPoint prediction,
                 GridPoint& p) {
    Around around_x;
    Around around_y;
    for (const KnotIndex gate : {d.a, d.b, d.behind}) {
      if (gate == kNoKnot) continue;
      around_x.add(sizes_[gate][0]);
      around_y.add(sizes_[gate][1]);
    }
    auto& alone = models_.free[old ? 1 : 0];
    if (!previous_.any()) {
      const std::int64_t x = code_residual(coder_, alone[0], around_x, p.x, prediction.x);
      around_y.size += x < 0 ? -x : x;
      ++around_y.count;
      code_residual(coder_, alone[1], around_y, p.y, prediction.y);
      return;
    }
    auto& models = models_.moving[old ? 1 : 0];
    const std::size_t area = area_class(area_at(d, prediction));
    const std::int64_t x =
        code_moved(models[0], alone[0], around_x, 0, moved, area, expected.x, expected.y, p.x, prediction.x);
    around_y.size += x < 0 ? -x : x;
    ++around_y.count;
    code_moved(models[1], alone[1], around_y, x, moved, area, expected.y, expected.x, p.y, prediction.y);
  }

  std::int64_t code_moved(MovingKnotModels& models, ResidualModels& alone, const Around& around,
                          std::int64_t other, std::size_t moved, std::size_t area, std::int64_t along,
                          std::int64_t across, std::int64_t& value, std::int64_t prediction) {
    const std::size_t size = expected_size(around);
    MixedNumber<4> magnitude(alone.magnitude[size],
                             {&models.beside[small_class(other) * ResidualModels::kSizes + size],
                              &models.around[moved * kSmallClasses + small_class(other)],
                              &models.area[area * ResidualModels::kSizes + size],
                              &models.expected[small_class(along) * kSmallClasses + small_class(across)]},
                             models.magnitude);
    return code_difference(
        coder_, magnitude,
        MixedBit<3>({&alone.negative[sign_class(around.sum)], &models.along[signed_class(along)],
                     &models.nearby[signed_class(around.twice_mean())]},
                    models.sign),
        value, prediction);
  }

  MixedBit<3> stay_model(std::uint8_t history, std::size_t moved, GridPoint expected) {
    StayModels& m = models_.stays;
    const std::size_t moves = (expected.x != 0 ? 2u : 0u) + (expected.y != 0 ? 1u : 0u);
    return {{&m.around[(history & 7u) * 16 + moved], &m.history[history * 4u + moves],
             &m.expected[(small_class(expected.x) * kSmallClasses + small_class(expected.y)) * 4 +
                         (history & 3u)]},
            m.mixer};
  }

  /// Of the knots around a gate, 4 times the number of those that have moved, and the number of old ones.
  std::size_t around_moved(const Discovery& d) const {
    std::size_t result = 0;
    for (const KnotIndex k : {d.a, d.b, d.behind}) {
      if (k == kNoKnot || !moves_[k].known) continue;
      result += moves_[k].x != 0 || moves_[k].y != 0 ? 5 : 1;
    }
    return result;
  }

  /// Twice the area of a triangle over the gate, in 1/256 px^2.
  std::int64_t area_at(const Discovery& d, GridPoint p) const {
    const GridPoint a = in_sixteenths(grid_.points[d.a], grid_.bits);
    const GridPoint b = in_sixteenths(grid_.points[d.b], grid_.bits);
    const GridPoint c = in_sixteenths(p, grid_.bits);
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
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
  std::vector<std::uint8_t>& stays_;  ///< of the frame's history
  std::int64_t width_;
  std::int64_t height_;
  std::vector<Move> moves_;                   ///< by knot
  std::vector<std::array<Around, 2>> sizes_;  ///< by free knot: its differences in x and y
};

}  // namespace knotreel::document
