// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/edge_lengths.h"

#include <algorithm>

namespace knotreel::mesh {

std::vector<double> shortest_edges(const KnotMesh& mesh) {
  std::vector<double> shortest(mesh.knots.size(), 1e300);
  for (const mesh::Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const KnotIndex a = f[i];
      const KnotIndex b = f[(i + 1) % 3];
      const double length = norm(mesh.knots[a].position - mesh.knots[b].position);
      shortest[a] = std::min(shortest[a], length);
      shortest[b] = std::min(shortest[b], length);
    }
  }
  return shortest;
}

}  // namespace knotreel::mesh
