// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "document/knot_layout.h"
#include "document/residual_coding.h"

/// Positions of free knots, when all others are known (docs/format.md, "Positions" and "Free knots of other
/// frames").
namespace knotreel::document {

template <class Coder>
class FreeKnotCoding {
 public:
  /// @param stays  of the history of this frame.
  FreeKnotCoding(Coder& coder, PositionModels& models, const KnotLayout& layout,
                 const PreviousKnots& previous, KnotGrid& grid, std::vector<std::uint8_t>& stays)
      : coder_(coder),
        models_(models),
        layout_(layout),
        previous_(previous),
        grid_(grid),
        stays_(stays),
        moves_(layout.mesh.knots.size()),
        differences_(layout.mesh.knots.size()) {}

  void run() {
    const std::vector<mesh::Knot>& knots = layout_.mesh.knots;
    stays_.assign(knots.size(), 0);
    for (KnotIndex k = 0; k < knots.size(); ++k) {
      if (knots[k].kind != KnotKind::kFree && previous_.matched(k)) set_move(k);
    }
    for (KnotIndex k = layout_.border_count; k < knots.size(); ++k) {
      if (knots[k].kind == KnotKind::kFree) code(k);
    }
  }

 private:
  /// How a knot has moved since the frame before.
  struct Move {
    bool known = false;
    std::int64_t x = 0;
    std::int64_t y = 0;
  };

  /// What is known of a knot before it is coded.
  struct Context {
    bool old;  ///< there is the same knot before
    GridPoint prediction;
    GridPoint expected;  ///< move of an old one
    std::size_t moved;   ///< of the knots around: 5 for each that has moved, 1 for each other old one
    std::size_t area;    ///< class of the triangle over the gate
    Around x;            ///< differences around
    Around y;
  };

  void code(KnotIndex k) {
    const Discovery& d = layout_.discoveries[k - layout_.border_count];
    const auto* match = previous_.match(k, KnotKind::kFree);
    const GridPoint was = match ? previous_.point(*match) : GridPoint{};
    const Context known = context(d, match ? &was : nullptr);
    GridPoint& p = grid_.points[k];
    bool stays = false;
    if (match) {
      const std::uint8_t history = previous_.stays(*match);
      stays = coder_.bit(stay_bit(history, known), p == was);
      stays_[k] = static_cast<std::uint8_t>(((history << 1) | (stays ? 1 : 0)) & 15);
    }
    if (stays) {
      p = was;
    } else {
      code_place(known, p);
    }
    layout_.require_inside(p, grid_.bits);
    if (!match) return;
    differences_[k][0].add(p.x - known.prediction.x);
    differences_[k][1].add(p.y - known.prediction.y);
    set_move(k);
  }

  /// @param was  null for new knots.
  Context context(const Discovery& d, const GridPoint* was) const {
    Context c{};
    c.old = was != nullptr;
    c.prediction = was ? carried(*was, d) : across(d);
    if (was) c.expected = {c.prediction.x - was->x, c.prediction.y - was->y};
    for (const KnotIndex k : {d.a, d.b, d.behind}) {
      if (k == kNoKnot) continue;
      c.x.add(differences_[k][0]);
      c.y.add(differences_[k][1]);
      if (moves_[k].known) c.moved += moves_[k].x != 0 || moves_[k].y != 0 ? 5 : 1;
    }
    const GridPoint a = in_sixteenths(grid_.points[d.a], grid_.bits);
    const GridPoint b = in_sixteenths(grid_.points[d.b], grid_.bits);
    const GridPoint p = in_sixteenths(c.prediction, grid_.bits);
    c.area = area_class((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x));
    return c;
  }

  MixedBit<3> stay_bit(std::uint8_t history, const Context& known) {
    StayModels& m = models_.stays;
    const GridPoint e = known.expected;
    const std::size_t moves = (e.x != 0 ? 2u : 0u) + (e.y != 0 ? 1u : 0u);
    const std::size_t sizes = small_class(e.x) * kSmallClasses + small_class(e.y);
    return {{&m.around[(history & 7u) * 16 + known.moved], &m.history[history * 4u + moves],
             &m.expected[sizes * 4 + (history & 3u)]},
            m.mixer};
  }

  void code_place(const Context& known, GridPoint& p) {
    auto& alone = models_.free[known.old ? 1 : 0];
    auto& models = models_.moving[known.old ? 1 : 0];
    const GridPoint from = known.prediction;
    const GridPoint e = known.expected;
    const bool mixed = previous_.any();
    const std::int64_t x = mixed ? code_mixed(models[0], alone[0], known, known.x, 0, e.x, e.y, p.x, from.x)
                                 : code_residual(coder_, alone[0], known.x, p.x, from.x);
    // How far x was off says how far y may be, but not to which side.
    Around y = known.y;
    y.size += x < 0 ? -x : x;
    ++y.count;
    if (mixed) {
      code_mixed(models[1], alone[1], known, y, x, e.y, e.x, p.y, from.y);
    } else {
      code_residual(coder_, alone[1], y, p.y, from.y);
    }
  }

  /// @param other           difference of the other coordinate, 0 if it comes later.
  /// @param expected        move along this coordinate. @param other_expected  along the other.
  std::int64_t code_mixed(MovingKnotModels& models, ResidualModels& alone, const Context& known,
                          const Around& around, std::int64_t other, std::int64_t expected,
                          std::int64_t other_expected, std::int64_t& value, std::int64_t prediction) {
    const std::size_t size = expected_size(around);
    const MixedNumber<4> magnitude(
        alone.magnitude[size],
        {&models.beside[small_class(other) * ResidualModels::kSizes + size],
         &models.around[known.moved * kSmallClasses + small_class(other)],
         &models.area[known.area * ResidualModels::kSizes + size],
         &models.expected[small_class(expected) * kSmallClasses + small_class(other_expected)]},
        models.magnitude);
    MixedBit<3> negative({&alone.negative[sign_class(around.sum)], &models.along[signed_class(expected)],
                          &models.nearby[signed_class(around.twice_mean())]},
                         models.sign);
    return code_difference(coder_, magnitude, negative, value, prediction);
  }

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
    return layout_.clamped(
        {p.x + floor_div(2 * sum.x + count, 2 * count), p.y + floor_div(2 * sum.y + count, 2 * count)},
        grid_.bits);
  }

  /// The fourth corner of a parallelogram over the gate; at the border, that of an equilateral triangle,
  /// nearly.
  GridPoint across(const Discovery& d) const {
    const GridPoint a = grid_.points[d.a];
    const GridPoint b = grid_.points[d.b];
    if (d.behind != kNoKnot) {
      const GridPoint p = grid_.points[d.behind];
      return layout_.clamped({a.x + b.x - p.x, a.y + b.y - p.y}, grid_.bits);
    }
    return layout_.clamped(
        {((a.x + b.x) >> 1) - ((7 * (b.y - a.y)) >> 3), ((a.y + b.y) >> 1) + ((7 * (b.x - a.x)) >> 3)},
        grid_.bits);
  }

  Coder& coder_;
  PositionModels& models_;
  const KnotLayout& layout_;
  const PreviousKnots& previous_;
  KnotGrid& grid_;
  std::vector<std::uint8_t>& stays_;
  std::vector<Move> moves_;                         ///< by knot
  std::vector<std::array<Around, 2>> differences_;  ///< by old free knot: of x and y
};

}  // namespace knotreel::document
