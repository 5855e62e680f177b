// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "param/curves.h"

namespace knotreel::param {

/// Two sites of a curve, by index; in closed curves `end` may be past the last site and wraps around.
struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;
};

inline SiteIndex site_of(const Curve& curve, std::size_t index) {
  return curve.sites[index % curve.sites.size()];
}

/// Spans between marked sites (Site::is_vertex), in order: the segments of the polyline. At least one site
/// must be marked, of open curves both ends.
std::vector<Span> segments_of(const Curves& curves, const Curve& curve);

/// The straight line between the ends of a span, and the sites between in its coordinates.
struct Chord {
  Vec2 a;
  Vec2 direction;  ///< of unit length
  double length = 0;
  std::vector<double> along;   ///< of the sites of the span, ends included, in pixels
  std::vector<double> offset;  ///< signed distance from the line
  double bulge = 0;            ///< largest distance of a site from the segment
  std::size_t farthest = 0;    ///< place in the span of the best site for a split; 0 if there is none inside
  bool advances = false;       ///< whether projections follow each other as the sites do
};

/// Measures a span. `scratch` is overwritten, so that its memory is used again.
void measure(const Curves& curves, const Curve& curve, Span span, Chord& scratch);

/// Whether a site that is not of the span lies between it and its chord, or is approached by the chord.
bool pocket_is_taken(const Curves& curves, const Curve& curve, std::uint32_t curve_index, Span span,
                     const Chord& chord);

}  // namespace knotreel::param
