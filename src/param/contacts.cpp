// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/contacts.h"

#include <algorithm>
#include <cmath>

#include "param/predicates.h"

namespace knotreel::param {
namespace {

constexpr double kCell = 8;  // pixels

/// Cells from the smallest to the largest that a piece's box touches.
struct CellBox {
  int x0, y0, x1, y1;
};

/// Of pieces that are nearer than the slack some share a cell: to have it on one side of each is enough.
CellBox cells_of(const Piece& p, Vec2 origin, double slack) {
  const auto cell = [](double v, double o) { return static_cast<int>(std::floor((v - o) / kCell)); };
  return {cell(std::min(p.a.x, p.b.x), origin.x), cell(std::min(p.a.y, p.b.y), origin.y),
          cell(std::max(p.a.x, p.b.x) + slack, origin.x), cell(std::max(p.a.y, p.b.y) + slack, origin.y)};
}

bool nearly_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double slack) {
  if (std::max(a.x, b.x) + slack < std::min(c.x, d.x) || std::max(c.x, d.x) + slack < std::min(a.x, b.x) ||
      std::max(a.y, b.y) + slack < std::min(c.y, d.y) || std::max(c.y, d.y) + slack < std::min(a.y, b.y))
    return false;
  return distance_to_segment(a, c, d) <= slack || distance_to_segment(b, c, d) <= slack ||
         distance_to_segment(c, a, b) <= slack || distance_to_segment(d, a, b) <= slack;
}

bool nearly_overlap(Vec2 common, Vec2 b, Vec2 c, double slack) {
  return dot(b - common, c - common) > 0 &&
         (distance_to_segment(b, common, c) <= slack || distance_to_segment(c, common, b) <= slack);
}

bool in_contact(const Piece& p, const Piece& q) {
  const bool from_from = p.from == q.from;
  const bool from_to = p.from == q.to;
  const bool to_from = p.to == q.from;
  const bool to_to = p.to == q.to;
  if ((from_from && to_to) || (from_to && to_from)) return true;
  if (from_from) return segments_overlap(p.a, p.b, q.b);
  if (from_to) return segments_overlap(p.a, p.b, q.a);
  if (to_from) return segments_overlap(p.b, p.a, q.b);
  if (to_to) return segments_overlap(p.b, p.a, q.a);
  return segments_meet(p.a, p.b, q.a, q.b);
}

bool nearly_in_contact(const Piece& p, const Piece& q, double slack) {
  if (p.from == q.from) return nearly_overlap(p.a, p.b, q.b, slack);
  if (p.from == q.to) return nearly_overlap(p.a, p.b, q.a, slack);
  if (p.to == q.from) return nearly_overlap(p.b, p.a, q.b, slack);
  if (p.to == q.to) return nearly_overlap(p.b, p.a, q.a, slack);
  return nearly_meet(p.a, p.b, q.a, q.b, slack);
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_contacts(const std::vector<Piece>& pieces,
                                                                   double slack) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts;
  if (pieces.empty()) return contacts;
  Vec2 low = pieces[0].a;
  Vec2 high = low;
  for (const Piece& p : pieces) {
    for (const Vec2 v : {p.a, p.b}) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y)};
    }
  }
  const int columns = static_cast<int>((high.x + slack - low.x) / kCell) + 1;
  const int rows = static_cast<int>((high.y + slack - low.y) / kCell) + 1;
  const auto cell_count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const auto for_cells = [&](const CellBox& b, const auto& body) {
    for (int y = b.y0; y <= b.y1; ++y) {
      for (int x = b.x0; x <= b.x1; ++x) {
        body(x, y,
             static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x));
      }
    }
  };

  std::vector<CellBox> boxes(pieces.size());
  std::vector<std::uint32_t> start(cell_count + 1, 0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    boxes[i] = cells_of(pieces[i], low, slack);
    for_cells(boxes[i], [&](int, int, std::size_t cell) { ++start[cell + 1]; });
  }
  for (std::size_t c = 0; c < cell_count; ++c) start[c + 1] += start[c];
  std::vector<std::uint32_t> members(start[cell_count]);
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    // Members of a cell are ascending, so those before this piece are the ones to compare it with.
    for_cells(boxes[i], [&](int x, int y, std::size_t cell) {
      for (std::uint32_t m = start[cell]; m < next[cell]; ++m) {
        const std::uint32_t j = members[m];
        // Two pieces may share several cells: they are compared in the first one only.
        if (x != std::max(boxes[i].x0, boxes[j].x0) || y != std::max(boxes[i].y0, boxes[j].y0)) continue;
        if (in_contact(pieces[j], pieces[i]) || (slack > 0 && nearly_in_contact(pieces[j], pieces[i], slack)))
          contacts.emplace_back(j, i);
      }
      members[next[cell]++] = i;
    });
  }
  return contacts;
}

}  // namespace knotreel::param
