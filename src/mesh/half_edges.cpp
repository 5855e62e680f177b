// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/half_edges.h"

#include <algorithm>
#include <numeric>

namespace knotreel::mesh {

namespace {

std::uint64_t undirected_key(const std::vector<Face>& faces, std::uint32_t h) {
  const KnotIndex a = origin(faces, h);
  const KnotIndex b = target(faces, h);
  return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
}

}  // namespace

std::vector<std::uint32_t> sorted_half_edges(const std::vector<Face>& faces) {
  const auto count = static_cast<std::uint32_t>(3 * faces.size());
  std::vector<KnotIndex> smaller(count);
  std::vector<KnotIndex> larger(count);
  KnotIndex last = 0;
  for (std::uint32_t h = 0; h < count; ++h) {
    const KnotIndex a = origin(faces, h);
    const KnotIndex b = target(faces, h);
    smaller[h] = std::min(a, b);
    larger[h] = std::max(a, b);
    last = std::max(last, larger[h]);
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  // Counted by the larger knot and then by the smaller one: each pass keeps the order of equals.
  std::vector<std::uint32_t> sorted(count);
  for (const std::vector<KnotIndex>* key : {&larger, &smaller}) {
    std::vector<std::uint32_t> cursor(static_cast<std::size_t>(last) + 2, 0);
    for (const KnotIndex k : *key) ++cursor[k + 1];
    for (std::size_t k = 1; k < cursor.size(); ++k) cursor[k] += cursor[k - 1];
    for (const std::uint32_t h : order) sorted[cursor[(*key)[h]]++] = h;
    order.swap(sorted);
  }
  return order;
}

std::optional<HalfEdges> connect_half_edges(const std::vector<Face>& faces) {
  return connect_half_edges(faces, sorted_half_edges(faces));
}

std::optional<HalfEdges> connect_half_edges(const std::vector<Face>& faces,
                                            const std::vector<std::uint32_t>& order) {
  HalfEdges result;
  result.opposite.assign(order.size(), kNoHalfEdge);
  for (std::size_t i = 0; i < order.size();) {
    const std::uint64_t key = undirected_key(faces, order[i]);
    std::size_t end = i + 1;
    while (end < order.size() && undirected_key(faces, order[end]) == key) ++end;
    if (end - i > 2) return std::nullopt;
    if (end - i == 2) {
      const std::uint32_t a = order[i];
      const std::uint32_t b = order[i + 1];
      if (origin(faces, a) == origin(faces, b)) return std::nullopt;
      result.opposite[a] = b;
      result.opposite[b] = a;
    }
    i = end;
  }
  return result;
}

}  // namespace knotreel::mesh
