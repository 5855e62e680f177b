// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/chord.h"

#include <algorithm>
#include <cmath>

namespace knotreel::param {
namespace {

/// Projections of consecutive sites keep at least this share of their distance. Zero would be one-to-one too,
/// but pixels next to the curve would be squeezed into slivers.
constexpr double kLeastAdvance = 0.2;
/// Splits prefer sites this far, in pixels, from both ends: shorter segments serve nobody.
constexpr double kShortSegment = 2;
/// A chord keeps this distance, in pixels, from sites that its curve is farther from.
constexpr double kClearance = 0.5;
/// Bulges so small leave no pocket: the chord is as good as the curve.
constexpr double kFlat = 0.05;

double distance_to_segment(double along, double offset, double length) {
  const double beyond = along < 0 ? -along : std::max(0.0, along - length);
  return std::sqrt(beyond * beyond + offset * offset);
}

/// Whether the span holds a site, as an end or inside.
bool holds(const Curves& curves, const Curve& curve, std::uint32_t curve_index, Span span, SiteIndex s) {
  if (s == site_of(curve, span.begin) || s == site_of(curve, span.end)) return true;
  const Site& site = curves.sites[s];
  if (site.curve != curve_index) return false;
  const std::size_t n = curve.sites.size();
  return (site.index >= span.begin && site.index <= span.end) ||
         (site.index + n >= span.begin && site.index + n <= span.end);
}

/// Offset of the curve where its projection is `along`.
double curve_offset(const Chord& chord, double along) {
  const auto next = std::upper_bound(chord.along.begin(), chord.along.end(), along);
  const auto i = std::clamp<std::ptrdiff_t>(next - chord.along.begin(), 1,
                                            static_cast<std::ptrdiff_t>(chord.along.size()) - 1);
  const auto k = static_cast<std::size_t>(i);
  const double share = (along - chord.along[k - 1]) / (chord.along[k] - chord.along[k - 1]);
  return chord.offset[k - 1] + share * (chord.offset[k] - chord.offset[k - 1]);
}

bool is_in_the_way(const Chord& chord, Vec2 q) {
  const double along = dot(q - chord.a, chord.direction);
  if (along <= 0 || along >= chord.length) return false;
  const double offset = cross(chord.direction, q - chord.a);
  const double curve = curve_offset(chord, along);
  if (offset * curve >= 0 && std::abs(offset) <= std::abs(curve)) return true;
  // Near the ends of a chord neighbours come close in any case.
  const double clearance = std::min(kClearance, 0.1 * std::min(along, chord.length - along));
  return std::abs(offset) < clearance && std::abs(offset - curve) > std::abs(offset) + kFlat;
}

}  // namespace

std::vector<Span> segments_of(const Curves& curves, const Curve& curve) {
  std::vector<std::size_t> marked;
  for (std::size_t i = 0; i < curve.sites.size(); ++i) {
    if (curves.sites[curve.sites[i]].is_vertex) marked.push_back(i);
  }
  std::vector<Span> spans;
  for (std::size_t i = 1; i < marked.size(); ++i) spans.push_back({marked[i - 1], marked[i]});
  if (curve.closed) spans.push_back({marked.back(), marked.front() + curve.sites.size()});
  return spans;
}

void measure(const Curves& curves, const Curve& curve, Span span, Chord& chord) {
  const auto at = [&](std::size_t k) { return curves.sites[site_of(curve, span.begin + k)].position; };
  const std::size_t count = span.end - span.begin + 1;
  chord.a = at(0);
  const Vec2 b = at(count - 1);
  chord.length = norm(b - chord.a);
  chord.direction = chord.length > 0 ? (1 / chord.length) * (b - chord.a) : Vec2{1, 0};
  chord.along.resize(count);
  chord.offset.resize(count);
  chord.bulge = 0;
  chord.farthest = 0;
  chord.advances = chord.length > 0;
  double best = -1;
  bool best_is_roomy = false;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 p = at(k);
    chord.along[k] = dot(p - chord.a, chord.direction);
    chord.offset[k] = cross(chord.direction, p - chord.a);
    if (k > 0 && chord.along[k] - chord.along[k - 1] < kLeastAdvance * norm(p - at(k - 1))) {
      chord.advances = false;
    }
    if (k == 0 || k + 1 == count) continue;
    const double distance = distance_to_segment(chord.along[k], chord.offset[k], chord.length);
    const bool roomy = norm(p - chord.a) >= kShortSegment && norm(p - b) >= kShortSegment;
    chord.bulge = std::max(chord.bulge, distance);
    if ((roomy && !best_is_roomy) || (roomy == best_is_roomy && distance > best)) {
      best = distance;
      best_is_roomy = roomy;
      chord.farthest = k;
    }
  }
}

bool pocket_is_taken(const Curves& curves, const Curve& curve, std::uint32_t curve_index, Span span,
                     const Chord& chord) {
  if (chord.bulge < kFlat) return false;
  const bool steep = std::abs(chord.direction.y) > std::abs(chord.direction.x);
  const double slope = steep ? chord.direction.x / chord.direction.y : chord.direction.y / chord.direction.x;
  const double start = steep ? chord.a.y : chord.a.x;
  const double other = steep ? chord.a.x : chord.a.y;
  const double end = start + chord.length * (steep ? chord.direction.y : chord.direction.x);
  // Positions lie up to one pixel per axis from their pixels.
  const double half = 1.5 * chord.bulge + kClearance + 2;
  const int first = static_cast<int>(std::floor(std::min(start, end))) - 1;
  const int last = static_cast<int>(std::floor(std::max(start, end))) + 1;
  for (int m = first; m <= last; ++m) {
    const double middle = other + (m + 0.5 - start) * slope;
    const int low = static_cast<int>(std::floor(middle - half));
    const int high = static_cast<int>(std::floor(middle + half));
    for (int n = low; n <= high; ++n) {
      const SiteIndex s = steep ? curves.site_at(n, m) : curves.site_at(m, n);
      if (s == kNone || holds(curves, curve, curve_index, span, s)) continue;
      if (is_in_the_way(chord, curves.sites[s].position)) return true;
    }
  }
  return false;
}

}  // namespace knotreel::param
