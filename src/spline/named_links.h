// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/small_vector.h"
#include "knotreel/spline/link.h"
#include "knotreel/spline/space.h"

namespace knotreel::spline {

/// The link triangulations of a space, to be found again for the links of another one. A link is known by the
/// names of the corners of its vertex and of its polygon.
class NamedLinks {
 public:
  using Triangles = SmallVector<PolygonTriangle, 8>;

  /// @param names of the corners of the space; of links with equal names the first is kept.
  NamedLinks(const SplineSpace& space, std::span<const std::uint32_t> names);

  /// The triangulation of the link with the names of `polygon`, in places of that polygon; empty if there is
  /// none. May be called from several threads.
  /// @param names of the corners of the polygon's space.
  Triangles find(const LinkPolygon& polygon, std::span<const std::uint32_t> names) const;

 private:
  /// Parts of the vectors below. The triangles count places from the start of the name's ring.
  struct Link {
    std::size_t name_begin;
    std::size_t name_end;
    std::size_t triangle_begin;
    std::size_t triangle_end;
  };

  std::span<const std::uint32_t> name_of(const Link& link) const {
    return std::span(names_).subspan(link.name_begin, link.name_end - link.name_begin);
  }

  std::vector<std::uint32_t> names_;
  std::vector<PolygonTriangle> triangles_;
  std::vector<Link> links_;  ///< by name, then in the order of the space
};

}  // namespace knotreel::spline
