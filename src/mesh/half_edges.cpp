#include "mesh/half_edges.h"

#include <algorithm>
#include <numeric>

namespace knotreel::mesh {

namespace {

std::uint64_t undirected_key(const std::vector<Face>& faces, std::uint32_t h) {
  const auto [lo, hi] = std::minmax({origin(faces, h), target(faces, h)});
  return (std::uint64_t{lo} << 32) | hi;
}

}  // namespace

std::vector<std::uint32_t> sorted_half_edges(const std::vector<Face>& faces) {
  // Counted into buckets of equal smaller knot, each of which is small.
  struct Keyed {
    KnotIndex larger;
    std::uint32_t half_edge;
  };
  const auto count = static_cast<std::uint32_t>(3 * faces.size());
  KnotIndex last = 0;
  for (const Face& f : faces) last = std::max({last, f[0], f[1], f[2]});
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(last) + 2, 0);
  for (std::uint32_t h = 0; h < count; ++h) ++begin[std::min(origin(faces, h), target(faces, h)) + 1];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<Keyed> keyed(count);
  std::vector<std::uint32_t> cursor(begin.begin(), begin.end() - 1);
  for (std::uint32_t h = 0; h < count; ++h) {
    const auto [lo, hi] = std::minmax({origin(faces, h), target(faces, h)});
    keyed[cursor[lo]++] = {hi, h};
  }
  for (std::size_t k = 0; k + 1 < begin.size(); ++k) {
    std::sort(keyed.begin() + begin[k], keyed.begin() + begin[k + 1], [](const Keyed& a, const Keyed& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.half_edge < b.half_edge;
    });
  }
  std::vector<std::uint32_t> order(count);
  std::transform(keyed.begin(), keyed.end(), order.begin(), [](const Keyed& k) { return k.half_edge; });
  return order;
}

std::optional<HalfEdges> connect_half_edges(const std::vector<Face>& faces) {
  const std::vector<std::uint32_t> order = sorted_half_edges(faces);
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
