// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "knotreel/base/parallel.h"
#include "param/chord.h"
#include "param/contacts.h"
#include "param/uncross.h"

namespace knotreel::param {
namespace {

// Pixels. Segments that are so near to each other are split where they can be, and one of those has to go
// that are so near that no grid of documents, 2^-14 pixels at most, may keep the face in between from turning
// over.
constexpr double kNear = 2.5e-3;
constexpr double kTouching = 2.5e-4;

/// Bulges that polyline_bulge does not forbid, in pixels.
constexpr double kHarmlessBulge = 1;

/// Between a preferred vertex and others, sites.
constexpr std::size_t kLeastApart = 3;

/// Index of the site with the largest measure; of equal ones that with the smallest pixel, so that it does
/// not matter where a closed chain starts.
template <typename Measure>
std::size_t farthest_site(const Curves& curves, const Curve& curve, const Measure& measure) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t i = 0; i < curve.sites.size(); ++i) {
    const Site& s = curves.sites[curve.sites[i]];
    const double m = measure(s.position);
    if (m > most || (m == most && s.pixel < curves.sites[curve.sites[best]].pixel)) {
      best = i;
      most = m;
    }
  }
  return best;
}

/// Curves that return to their start begin with a triangle: its corners are, about, the farthest two sites
/// (or the node) and the one farthest off the line between them.
void mark_triangle(Curves& curves, const Curve& curve) {
  const auto position = [&](std::size_t i) { return curves.sites[curve.sites[i]].position; };
  std::size_t first = 0;
  if (curve.closed) {
    Vec2 middle;
    for (std::size_t i = 0; i < curve.sites.size(); ++i) middle = middle + position(i);
    middle = (1 / static_cast<double>(curve.sites.size())) * middle;
    first = farthest_site(curves, curve, [&](Vec2 p) { return norm(p - middle); });
  }
  const Vec2 a = position(first);
  const std::size_t second = farthest_site(curves, curve, [&](Vec2 p) { return norm(p - a); });
  const Vec2 b = position(second);
  const std::size_t third =
      farthest_site(curves, curve, [&](Vec2 p) { return std::abs(signed_area(a, b, p)); });
  for (const std::size_t i : {first, second, third}) {
    Site& site = curves.sites[curve.sites[i]];
    if (!site.is_vertex) site.is_vertex = true;  // nodes are shared: other threads may be reading them
  }
}

class Simplifier {
 public:
  Simplifier(Curves& curves, std::uint32_t index, const ParametrizeOptions& options)
      : curves_(curves),
        curve_(curves.curves[index]),
        index_(index),
        options_(options),
        distance_(curve_.stepped ? std::max(options.polyline_distance, options.stepped_distance)
                                 : options.polyline_distance) {}

  /// Whether one segment may take its place.
  bool is_straight(Span span) {
    measure(curves_, curve_, span, chord_);
    return is_accepted(span);
  }

  void refine(Span span) {
    std::vector<Span> open{span};
    while (!open.empty()) {
      const Span s = open.back();
      open.pop_back();
      if (s.end - s.begin < 2) continue;
      measure(curves_, curve_, s, chord_);
      if (is_accepted(s)) continue;
      const std::size_t middle = s.begin + chord_.farthest;
      curves_.sites[site_of(curve_, middle)].is_vertex = true;
      open.push_back({s.begin, middle});
      open.push_back({middle, s.end});
    }
  }

 private:
  bool is_accepted(Span s) const {
    if (!chord_.advances || chord_.bulge > distance_) return false;
    const double allowed = std::max(kHarmlessBulge, options_.polyline_bulge * chord_.length);
    return chord_.bulge <= allowed && !pocket_is_taken(curves_, curve_, index_, s, chord_);
  }

  Curves& curves_;
  const Curve& curve_;
  std::uint32_t index_;
  const ParametrizeOptions& options_;
  double distance_;
  Chord chord_;
};

/// Marks the best site inside a span. @return false if there is none.
bool split(Curves& curves, const Curve& curve, Span span) {
  if (span.end - span.begin < 2) return false;
  Chord chord;
  measure(curves, curve, span, chord);
  curves.sites[site_of(curve, span.begin + chord.farthest)].is_vertex = true;
  return true;
}

/// Places of the sites of a curve that are vertices or preferred, but for these next to others.
std::vector<std::size_t> vertices_to_keep(const Curves& curves, const Curve& curve) {
  const auto is_fixed = [&](std::size_t k) { return curves.sites[site_of(curve, k)].is_vertex; };
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < curve.sites.size(); ++k) {
    const Site& site = curves.sites[curve.sites[k]];
    if (!site.is_vertex && !(site.preferred && site.curve != kNone)) continue;
    const bool too_near = !kept.empty() && k - kept.back() < kLeastApart;
    if (too_near && !site.is_vertex) continue;
    if (too_near && !is_fixed(kept.back())) kept.pop_back();
    kept.push_back(k);
  }
  if (!curve.closed || kept.size() < 2) return kept;
  // Round the end, too.
  if (kept.front() + curve.sites.size() - kept.back() >= kLeastApart) return kept;
  if (!is_fixed(kept.back())) {
    kept.pop_back();
  } else if (!is_fixed(kept.front())) {
    kept.erase(kept.begin());
  }
  return kept;
}

/// From the vertex before one to that behind it. Those at the ends of an open curve have none of these.
Span around(const Curve& curve, const std::vector<std::size_t>& vertices, std::size_t k) {
  const std::size_t n = curve.sites.size();
  const std::size_t before = k > 0 ? vertices[k - 1] : vertices.back();
  const std::size_t behind = k + 1 < vertices.size() ? vertices[k + 1] : vertices.front() + n;
  return before < behind && k > 0 ? Span{before, behind} : Span{before, behind + n};
}

struct Segment {
  std::uint32_t curve;
  Span span;
};

}  // namespace

void mark_preferred(Curves& curves, const ParametrizeOptions& options) {
  parallel_for(curves.curves.size(), [&](std::size_t i) {
    const Curve& curve = curves.curves[i];
    std::vector<std::size_t> kept = vertices_to_keep(curves, curve);
    const std::size_t least = curve.closed ? 3 : 2;
    if (kept.size() < least) return;
    Simplifier simplifier(curves, static_cast<std::uint32_t>(i), options);
    for (std::size_t k = 0; k < kept.size() && kept.size() > least;) {
      const bool fixed = curves.sites[curve.sites[kept[k]]].is_vertex;
      if (!fixed && simplifier.is_straight(around(curve, kept, k))) {
        kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(k));
      } else {
        ++k;
      }
    }
    for (const std::size_t k : kept) {
      Site& site = curves.sites[curve.sites[k]];
      if (!site.is_vertex) site.is_vertex = true;  // nodes are shared: other threads may be reading them
    }
  });
}

void simplify(Curves& curves, const ParametrizeOptions& options) {
  parallel_for(curves.curves.size(), [&](std::size_t i) {
    const Curve& curve = curves.curves[i];
    if (curve.dropped) return;
    const bool marked = std::any_of(curve.sites.begin(), curve.sites.end(),
                                    [&](SiteIndex s) { return curves.sites[s].is_vertex; });
    const bool returns = curve.closed || curve.sites.front() == curve.sites.back();
    if (returns && (!curve.closed || !marked)) mark_triangle(curves, curve);
    Simplifier simplifier(curves, static_cast<std::uint32_t>(i), options);
    for (const Span span : segments_of(curves, curve)) simplifier.refine(span);
  });
}

int make_planar(Curves& curves, const ParametrizeOptions& options) {
  int dropped = 0;
  while (true) {
    std::vector<Segment> segments;
    std::vector<Piece> pieces;
    for (std::uint32_t c = 0; c < curves.curves.size(); ++c) {
      const Curve& curve = curves.curves[c];
      if (curve.dropped) continue;
      for (const Span span : segments_of(curves, curve)) {
        const SiteIndex a = site_of(curve, span.begin);
        const SiteIndex b = site_of(curve, span.end);
        segments.push_back({c, span});
        pieces.push_back({a, b, curves.sites[a].position, curves.sites[b].position});
      }
    }
    const auto near = find_contacts(pieces, kNear);
    if (near.empty()) return dropped;
    bool changed = false;
    for (const auto& [p, q] : near) {
      for (const std::uint32_t i : {p, q}) {
        changed = split(curves, curves.curves[segments[i].curve], segments[i].span) || changed;
      }
    }
    if (changed) {
      simplify(curves, options);
      continue;
    }
    const auto contacts = find_contacts(pieces, kTouching);
    if (contacts.empty()) return dropped;
    drop(curves, segments[contacts.front().second].curve);
    ++dropped;
  }
}

bool split_segments_of(Curves& curves, const std::vector<SiteIndex>& sites) {
  std::vector<std::array<std::size_t, 3>> segments;  // curve, begin, end
  for (const SiteIndex s : sites) {
    const Site& site = curves.sites[s];
    if (site.curve == kNone || curves.curves[site.curve].dropped) continue;
    const Curve& curve = curves.curves[site.curve];
    const std::size_t n = curve.sites.size();
    // A vertex stands for the segment after it; that before has other sites near by.
    std::size_t begin = site.index + n;
    while (!curves.sites[site_of(curve, begin)].is_vertex) --begin;
    std::size_t end = site.index + n + 1;
    while (!curves.sites[site_of(curve, end)].is_vertex) ++end;
    segments.push_back({site.curve, begin % n, begin % n + (end - begin)});
  }
  std::sort(segments.begin(), segments.end());
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  bool changed = false;
  for (const auto& [curve, begin, end] : segments) {
    changed = split(curves, curves.curves[curve], {begin, end}) || changed;
  }
  return changed;
}

}  // namespace knotreel::param
