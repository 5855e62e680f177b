// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/conquest.h"

#include "document/bytes.h"

namespace knotreel::document {
Loops::Loops(std::size_t border_count) {
  const auto n = static_cast<std::uint32_t>(border_count);
  nodes_.reserve(border_count);
  for (std::uint32_t i = 0; i < n; ++i) nodes_.push_back({i, (i + 1) % n, (i + n - 1) % n, kNoKnot});
  stack_.push_back({0, border_count});
}

void Loops::found(KnotIndex x) {
  const std::uint32_t a = gate_a();
  const std::uint32_t b = gate_b();
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({x, b, a, nodes_[a].knot});
  nodes_[a].next = node;
  nodes_[a].behind = nodes_[b].knot;
  nodes_[b].previous = node;
  stack_.back() = {node, length() + 1};
}

void Loops::right() {
  if (length() == 3) {
    stack_.pop_back();
    return;
  }
  const std::uint32_t a = gate_a();
  const std::uint32_t b = gate_b();
  const std::uint32_t x = nodes_[b].next;
  nodes_[a].next = x;
  nodes_[a].behind = nodes_[b].knot;
  nodes_[x].previous = a;
  stack_.back() = {a, length() - 1};
}

void Loops::left() {
  const std::uint32_t a = gate_a();
  const std::uint32_t b = gate_b();
  const std::uint32_t x = nodes_[a].previous;
  nodes_[x].next = b;
  nodes_[x].behind = nodes_[a].knot;
  nodes_[b].previous = x;
  stack_.back() = {x, length() - 1};
}

KnotIndex Loops::split(std::uint64_t code) {
  const std::size_t steps = code / 2 + 2;
  if (length() < 5 || steps > length() - 3) malformed("a split reaches beyond its loop");
  const std::uint32_t a = gate_a();
  const std::uint32_t b = gate_b();
  // The writer takes the shorter way round, so that all the walks of a file cost O(n log n).
  const std::size_t other = length() - 1 - steps;
  if (code % 2 == 0 ? steps > other : steps >= other) malformed("a split goes the long way round");
  std::uint32_t x = code % 2 == 0 ? b : a;
  for (std::size_t i = 0; i < steps; ++i) x = code % 2 == 0 ? nodes_[x].next : nodes_[x].previous;
  const std::size_t after_b = code % 2 == 0 ? steps : other;

  // x keeps its place in the loop x .. a; a second node stands for it in the loop b .. x.
  const auto twin = static_cast<std::uint32_t>(nodes_.size());
  const KnotIndex knot = nodes_[x].knot;
  nodes_.push_back({knot, b, nodes_[x].previous, nodes_[a].knot});
  nodes_[nodes_[x].previous].next = twin;
  nodes_[a].next = x;
  nodes_[a].behind = nodes_[b].knot;
  nodes_[x].previous = a;
  nodes_[b].previous = twin;
  stack_.back() = {a, length() - after_b};
  stack_.push_back({twin, after_b + 1});
  return knot;
}

std::uint64_t Loops::split_code(KnotIndex x) const {
  std::uint32_t forward = nodes_[gate_b()].next;
  std::uint32_t backward = nodes_[gate_a()].previous;
  for (std::size_t s = 0; 2 * s < length(); ++s) {
    forward = nodes_[forward].next;
    backward = nodes_[backward].previous;
    if (nodes_[forward].knot == x) return 2 * s;
    if (nodes_[backward].knot == x) return 2 * s + 1;
  }
  malformed("the mesh is not a disk");
}

Conquered conquer(const EdgeTable& edges, const std::vector<KnotIndex>& border) {
  const std::size_t knot_count = edges.knot_count();
  const std::size_t face_count = edges.face_count();
  Conquered result;
  Conquest& out = result.conquest;
  out.faces.reserve(face_count);
  result.face_of.reserve(face_count);
  result.knot_of = border;
  std::vector<KnotIndex> canonical(knot_count, kNoKnot);
  for (std::uint32_t i = 0; i < border.size(); ++i) canonical[border[i]] = i;

  Loops loops(border.size());
  while (!loops.done()) {
    const KnotIndex a = loops.a();
    const KnotIndex b = loops.b();
    const EdgeTable::Side* side = edges.find(result.knot_of[a], result.knot_of[b]);
    if (!side || out.faces.size() == face_count) malformed("the mesh is not a disk");
    KnotIndex x = canonical[side->apex];
    if (x == kNoKnot) {
      x = canonical[side->apex] = static_cast<KnotIndex>(result.knot_of.size());
      result.knot_of.push_back(side->apex);
      out.discoveries.push_back({a, b, loops.behind()});
      loops.found(x);
    } else if (x == loops.after()) {
      loops.right();
    } else if (x == loops.before()) {
      loops.left();
    } else {
      loops.split(loops.split_code(x));
    }
    out.faces.push_back({a, b, x});
    result.face_of.push_back(side->face);
  }
  if (out.faces.size() != face_count || result.knot_of.size() != knot_count)
    malformed("the mesh is not a disk");
  return result;
}

}  // namespace knotreel::document
