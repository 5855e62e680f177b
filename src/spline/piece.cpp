// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/piece.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace knotreel::spline {

namespace {

// Triples of knots thinner than this, relative to their squared diameter, count as collinear.
constexpr double kFlat = 1e-11;

/// Collects what tents need to know about corners of one space.
class TentMaker {
 public:
  explicit TentMaker(const SplineSpace& space, const KnotShift* shift = nullptr)
      : space_(space), shift_(shift), sides_(space.mesh().segments.size()) {}

  Vec2 at(CornerIndex c) const {
    return shift_ && knot(c) == shift_->knot ? shift_->position : space_.position(c);
  }
  /// Without the shift.
  Vec2 at_rest(CornerIndex c) const { return space_.position(c); }

  /// Degree 0: 1/area inside the triangle.
  std::optional<Tent> constant(const std::array<CornerIndex, 3>& t) const {
    const double area = signed_area(at(t[0]), at(t[1]), at(t[2]));
    if (!(area > 0)) return std::nullopt;
    Tent tent;
    tent.constant = 1 / area;
    for (std::size_t i = 0; i < 3; ++i) add_wall(tent, t[i], t[(i + 1) % 3], at(t[(i + 2) % 3]));
    return tent;
  }

  /// Degree 1: four corners, possibly repeated.
  std::optional<Tent> linear(std::array<CornerIndex, 4> c) const {
    std::sort(c.begin(), c.end(), [&](CornerIndex a, CornerIndex b) { return knot(a) < knot(b); });
    for (std::size_t i = 0; i < 3; ++i) {
      if (knot(c[i]) == knot(c[i + 1])) {
        std::rotate(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(i), c.end());
        return with_double_knot(c[0], c[2], c[3]);
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<CornerIndex, 3> three{};
      for (std::size_t j = 0; j < 3; ++j) three[j] = c[(i + 1 + j) % 4];
      if (collinear(three[0], three[1], three[2])) return with_collinear_knots(three, c[i]);
    }
    return in_general_position(c);
  }

 private:
  mesh::KnotIndex knot(CornerIndex c) const { return space_.cut().corners[c].knot; }

  /// A line of the cut that holds both corners.
  std::uint32_t common_line(CornerIndex a, CornerIndex b) const {
    const mesh::Corner& p = space_.cut().corners[a];
    const mesh::Corner& q = space_.cut().corners[b];
    for (const std::uint32_t line : {p.first_line, p.last_line}) {
      if (line != mesh::kNoLine && (line == q.first_line || line == q.last_line)) return line;
    }
    return mesh::kNoLine;
  }

  bool collinear(CornerIndex a, CornerIndex b, CornerIndex c) const {
    const std::uint32_t line = common_line(a, b);
    if (line != mesh::kNoLine && line == common_line(b, c) && line == common_line(a, c)) return true;
    const Vec2 ab = at(b) - at(a);
    const Vec2 ac = at(c) - at(a);
    const Vec2 bc = at(c) - at(b);
    const double diameter2 = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
    return std::abs(cross(ab, ac)) <= 2 * kFlat * diameter2;
  }

  /// The linear function that vanishes on the line a-b, with the slope of a simplex spline whose other knots
  /// are r and s: area(u,a,b) / (area(a,b,r) area(a,b,s)).
  static void add_slope(Tent& tent, Vec2 a, Vec2 b, Vec2 r, Vec2 s) {
    const double ar = signed_area(a, b, r);
    const double scale = 0.5 / (ar * signed_area(a, b, s)) * (ar > 0 ? 1 : -1);
    const Vec2 e = b - a;
    tent.slopes[static_cast<std::size_t>(tent.slope_count++)] = {-e.y * scale, e.x * scale, a.x, a.y};
  }

  /// A wall along a-b with r inside. Its coefficients depend on the line only, up to an exact change of sign,
  /// so that the supports on its two sides share no point and leave none out. The sides of the domain need
  /// none.
  void add_wall(Tent& tent, CornerIndex a, CornerIndex b, Vec2 r) const {
    const std::uint32_t line = common_line(a, b);
    if (line != mesh::kNoLine && line >= sides_) return;
    Vec2 from = at(a);
    Vec2 to = at(b);
    if (line != mesh::kNoLine) {
      from = space_.cut().lines[line].from;
      to = space_.cut().lines[line].to;
    } else if (to.x < from.x || (to.x == from.x && to.y < from.y)) {
      std::swap(from, to);
    }
    const Vec2 e = to - from;
    const double length = norm(e);
    Affine wall{-e.y / length, e.x / length, from.x, from.y};
    if (wall(r) < 0) wall = {-wall.nx, -wall.ny, wall.px, wall.py};
    tent.walls[static_cast<std::size_t>(tent.wall_count++)] = wall;
  }

  std::optional<Tent> with_double_knot(CornerIndex a, CornerIndex y, CornerIndex z) const {
    if (knot(y) == knot(z) || knot(a) == knot(y) || knot(a) == knot(z)) return std::nullopt;
    if (collinear(a, y, z)) return std::nullopt;
    Tent tent;
    add_slope(tent, at(y), at(z), at(a), at(a));
    add_wall(tent, a, y, at(z));
    add_wall(tent, a, z, at(y));
    return tent;
  }

  std::optional<Tent> with_collinear_knots(std::array<CornerIndex, 3> line, CornerIndex apex) const {
    // Order along the line, at rest: the direction must not turn where the middle knot is half way.
    const Vec2 d0 = at_rest(line[1]) - at_rest(line[0]);
    const Vec2 d1 = at_rest(line[2]) - at_rest(line[0]);
    const Vec2 direction = dot(d0, d0) > dot(d1, d1) ? d0 : d1;
    std::sort(line.begin(), line.end(), [&](CornerIndex a, CornerIndex b) {
      return dot(at_rest(a), direction) < dot(at_rest(b), direction);
    });
    const auto [p, m, q] = line;
    if (collinear(p, q, apex)) return std::nullopt;
    Tent tent;
    add_slope(tent, at(p), at(apex), at(m), at(q));
    add_slope(tent, at(q), at(apex), at(m), at(p));
    add_wall(tent, p, q, at(apex));
    return tent;
  }

  std::optional<Tent> in_general_position(const std::array<CornerIndex, 4>& c) const {
    static constexpr std::size_t kPairs[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                                 {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
    Tent tent;
    for (const auto& [i, j, r, s] : kPairs) {
      const double side_r = signed_area(at(c[i]), at(c[j]), at(c[r]));
      const double side_s = signed_area(at(c[i]), at(c[j]), at(c[s]));
      const bool hull_edge = (side_r > 0) == (side_s > 0);
      if (hull_edge && tent.slope_count < 4) add_slope(tent, at(c[i]), at(c[j]), at(c[r]), at(c[s]));
    }
    return tent;
  }

  const SplineSpace& space_;
  const KnotShift* shift_;
  std::size_t sides_;
};

Affine area_weight(Vec2 b, Vec2 c) {
  const Vec2 e = c - b;
  return {-0.5 * e.y, 0.5 * e.x, b.x, b.y};
}

/// Cuts M_2(u | V) into three tents by the recurrence on the triangle of largest area (paper Eq. 1). Largest
/// without the shift: where areas tie, a shift would cut otherwise, and pieces could not be subtracted.
void add_quadratic(const TentMaker& maker, const std::array<CornerIndex, 5>& v,
                   std::vector<PieceTerm>& terms) {
  double largest = 0;
  std::array<std::size_t, 3> t{};
  const auto at = [&](std::size_t i) { return maker.at(v[i]); };
  const auto rest = [&](std::size_t i) { return maker.at_rest(v[i]); };
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = i + 1; j < 5; ++j) {
      for (std::size_t k = j + 1; k < 5; ++k) {
        const double area = std::abs(signed_area(rest(i), rest(j), rest(k)));
        if (area > largest) {
          largest = area;
          t = {i, j, k};
        }
      }
    }
  }
  if (largest == 0) return;
  const double area = signed_area(at(t[0]), at(t[1]), at(t[2]));
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<CornerIndex, 4> others{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      if (i != t[j]) others[n++] = v[i];
    }
    const auto tent = maker.linear(others);
    if (!tent) continue;
    Affine factor = area_weight(at(t[(j + 1) % 3]), at(t[(j + 2) % 3]));
    factor.nx /= area;
    factor.ny /= area;
    terms.push_back({*tent, factor, true, {}, {}});
  }
}

void bound_terms(const TentMaker& maker, std::span<const CornerIndex> corners, std::span<PieceTerm> terms) {
  Vec2 low = maker.at(corners[0]);
  Vec2 high = low;
  for (const CornerIndex c : corners) {
    const Vec2 p = maker.at(c);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  for (PieceTerm& term : terms) {
    term.low = low;
    term.high = high;
  }
}

Piece add_piece(const TentMaker& maker, const Config& config, int degree, std::vector<PieceTerm>& terms) {
  const auto& t = config.triangle;
  Piece piece;
  piece.functions = config.functions;
  for (std::size_t i = 0; i < 3; ++i) {
    piece.weights[i] = area_weight(maker.at(t[(i + 1) % 3]), maker.at(t[(i + 2) % 3]));
  }
  piece.term_begin = static_cast<std::uint32_t>(terms.size());
  if (degree == 1) {
    if (const auto tent = maker.constant(t)) terms.push_back({*tent, {}, false, {}, {}});
  } else if (degree == 2) {
    if (const auto tent = maker.linear({t[0], t[1], t[2], config.inner[0]})) {
      terms.push_back({*tent, {}, false, {}, {}});
    }
  } else {
    add_quadratic(maker, {t[0], t[1], t[2], config.inner[0], config.inner[1]}, terms);
  }
  piece.term_end = static_cast<std::uint32_t>(terms.size());
  const std::array<CornerIndex, 5> all{t[0], t[1], t[2], config.inner[0], config.inner[1]};
  bound_terms(maker, std::span(all).first(2 + static_cast<std::size_t>(degree)),
              std::span(terms).subspan(piece.term_begin));
  return piece;
}

}  // namespace

PieceSet make_pieces(const SplineSpace& space) {
  const TentMaker maker(space);
  PieceSet set;
  set.pieces.reserve(space.configs().size());
  set.terms.reserve(space.configs().size() * (space.degree() == 3 ? 3 : 1));
  for (const Config& config : space.configs()) {
    set.pieces.push_back(add_piece(maker, config, space.degree(), set.terms));
  }
  return set;
}

Piece make_shifted_piece(const SplineSpace& space, std::size_t config, const KnotShift& shift,
                         std::vector<PieceTerm>& terms) {
  return add_piece(TentMaker(space, &shift), space.configs()[config], space.degree(), terms);
}

}  // namespace knotreel::spline
