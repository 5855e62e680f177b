// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::document {

/// Third corner and number of the face at every directed edge of a mesh.
class EdgeTable {
 public:
  struct Side {
    mesh::KnotIndex to;
    mesh::KnotIndex apex;
    std::uint32_t face;
  };

  EdgeTable(std::size_t knot_count, const std::vector<mesh::Face>& faces)
      : begin_(knot_count + 1), sides_(3 * faces.size()) {
    for (const mesh::Face& face : faces) {
      for (const mesh::KnotIndex k : face) ++begin_[k + 1];
    }
    for (std::size_t k = 0; k < knot_count; ++k) begin_[k + 1] += begin_[k];
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      for (std::size_t i = 0; i < 3; ++i) {
        const mesh::Face& face = faces[f];
        sides_[cursor[face[i]]++] = {face[(i + 1) % 3], face[(i + 2) % 3], f};
      }
    }
    // Sorted, so that knots of high valence do not make the search quadratic.
    for (std::size_t k = 0; k < knot_count; ++k) {
      std::sort(sides_.begin() + static_cast<std::ptrdiff_t>(begin_[k]),
                sides_.begin() + static_cast<std::ptrdiff_t>(begin_[k + 1]),
                [](const Side& x, const Side& y) { return x.to < y.to; });
    }
  }

  std::size_t knot_count() const { return begin_.size() - 1; }
  std::size_t face_count() const { return sides_.size() / 3; }

  /// Edges out of a knot, by their other end.
  std::span<const Side> from(mesh::KnotIndex k) const {
    return std::span(sides_).subspan(begin_[k], begin_[k + 1] - begin_[k]);
  }
  /// The side of an edge, or null.
  const Side* find(mesh::KnotIndex a, mesh::KnotIndex b) const {
    const auto sides = from(a);
    const auto it = std::ranges::lower_bound(sides, b, {}, &Side::to);
    return it != sides.end() && it->to == b ? &*it : nullptr;
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Side> sides_;
};

}  // namespace knotreel::document
