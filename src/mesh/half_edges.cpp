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
  struct Keyed {
    std::uint64_t key;
    std::uint32_t half_edge;
  };
  std::vector<Keyed> keyed(3 * faces.size());
  for (std::uint32_t h = 0; h < keyed.size(); ++h) keyed[h] = {undirected_key(faces, h), h};
  std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key < b.key : a.half_edge < b.half_edge;
  });
  std::vector<std::uint32_t> order(keyed.size());
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
