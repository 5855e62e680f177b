// SPDX-License-Identifier: GPL-3.0-or-later
#include "spline/named_links.h"

#include <algorithm>

namespace knotreel::spline {

namespace {

/// Appends the name of a link: its vertex, ascending, and its ring, turned to start with its least name.
/// @return the place in the polygon where the ring starts.
template <class Names>
std::size_t append_name(const LinkPolygon& polygon, std::span<const std::uint32_t> names, Names& out) {
  const auto vertex = static_cast<std::ptrdiff_t>(out.size());
  for (const CornerIndex c : polygon.vertex) out.push_back(names[c]);
  std::sort(out.begin() + vertex, out.end());
  const auto ring = static_cast<std::ptrdiff_t>(out.size());
  for (const CornerIndex c : polygon.corners) out.push_back(names[c]);
  const auto least = std::min_element(out.begin() + ring, out.end());
  const auto turn = static_cast<std::size_t>(least - out.begin() - ring);
  std::rotate(out.begin() + ring, least, out.end());
  return turn;
}

void turn(std::span<PolygonTriangle> triangles, std::size_t by, std::size_t n) {
  for (PolygonTriangle& t : triangles) {
    for (std::uint32_t& place : t) place = static_cast<std::uint32_t>((place + by) % n);
  }
}

}  // namespace

NamedLinks::NamedLinks(const SplineSpace& space, std::span<const std::uint32_t> names) {
  for_each_link(space, [&](const LinkPolygon& polygon, auto, std::span<const PolygonTriangle> triangles) {
    Link link{names_.size(), 0, triangles_.size(), 0};
    const std::size_t n = polygon.corners.size();
    const std::size_t start = append_name(polygon, names, names_);
    triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
    turn(std::span(triangles_).subspan(link.triangle_begin), n - start, n);
    link.name_end = names_.size();
    link.triangle_end = triangles_.size();
    links_.push_back(link);
  });
  std::stable_sort(links_.begin(), links_.end(), [&](const Link& a, const Link& b) {
    return std::ranges::lexicographical_compare(name_of(a), name_of(b));
  });
}

NamedLinks::Triangles NamedLinks::find(const LinkPolygon& polygon,
                                       std::span<const std::uint32_t> names) const {
  SmallVector<std::uint32_t, 16> name;
  const std::size_t start = append_name(polygon, names, name);
  const auto less = [&](const Link& link, std::span<const std::uint32_t> wanted) {
    return std::ranges::lexicographical_compare(name_of(link), wanted);
  };
  const auto link = std::lower_bound(links_.begin(), links_.end(),
                                     std::span<const std::uint32_t>(name.data(), name.size()), less);
  if (link == links_.end() || !std::ranges::equal(name_of(*link), name)) return {};
  const auto first = triangles_.begin() + static_cast<std::ptrdiff_t>(link->triangle_begin);
  const auto last = triangles_.begin() + static_cast<std::ptrdiff_t>(link->triangle_end);
  Triangles triangles(first, last);
  turn({triangles.data(), triangles.size()}, start, polygon.corners.size());
  return triangles;
}

}  // namespace knotreel::spline
