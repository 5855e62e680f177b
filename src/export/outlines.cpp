// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/outlines.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "knotreel/base/parallel.h"

namespace knotreel::exporting {

namespace {

// The lines below the regions, which are 0.6 px wide on each side, have to cover what is between them.
constexpr double kFarthest = 0.5;

/// Edges between two regions, from one vertex where others come to the next, or round in a circle.
struct Arc {
  std::vector<std::uint32_t> half_edges;  ///< of the region on its left
  std::uint32_t left = 0;
  std::uint32_t right = kNoIndex;  ///< kNoIndex: the border of the picture
  std::vector<Curve> curves;
};

Curve part_of(const Curve& c, double t0, double t1) {
  const auto blossom = [&](double a, double b, double d) {
    const auto mix = [](Vec2 p, Vec2 q, double t) { return (1 - t) * p + t * q; };
    const Vec2 p = mix(c[0], c[1], a);
    const Vec2 q = mix(c[1], c[2], a);
    const Vec2 r = mix(c[2], c[3], a);
    return mix(mix(p, q, b), mix(q, r, b), d);
  };
  return {blossom(t0, t0, t0), blossom(t0, t0, t1), blossom(t0, t1, t1), blossom(t1, t1, t1)};
}

class Tracer {
 public:
  Tracer(const Tessellator& tessellator, const Triangulation& triangles, const Partition& partition)
      : sheets_(tessellator.sheets()), t_(triangles), p_(partition) {
    collect_edges();
  }

  std::vector<std::vector<Loop>> run(const OutlineOptions& options) {
    trace_arcs();
    parallel_for(arcs_.size(), [&](std::size_t i) {
      arcs_[i].curves = simplified(chain_of(arcs_[i]), tolerance(arcs_[i], options));
    });
    return join_arcs();
  }

 private:
  std::uint32_t region(std::uint32_t h) const { return h == kNoIndex ? kNoIndex : p_.region_of[h / 3]; }
  bool is_boundary(std::uint32_t h) const { return region(h) != region(t_.opposite[h]); }

  /// The boundary edges at each vertex, each by one of its half edges.
  void collect_edges() {
    begin_.assign(t_.x.size() + 1, 0);
    const auto for_each = [&](auto visit) {
      for (std::uint32_t h = 0; h < t_.opposite.size(); ++h) {
        if (is_boundary(h) && h < t_.opposite[h]) visit(h);
      }
    };
    for_each([&](std::uint32_t h) {
      ++begin_[t_.vertex(h) + 1];
      ++begin_[t_.target(h) + 1];
    });
    for (std::size_t v = 0; v < t_.x.size(); ++v) begin_[v + 1] += begin_[v];
    edges_.resize(begin_.back());
    std::vector<std::uint32_t> cursor(begin_.begin(), begin_.end() - 1);
    for_each([&](std::uint32_t h) {
      edges_[cursor[t_.vertex(h)]++] = h;
      edges_[cursor[t_.target(h)]++] = h;
    });
  }

  bool is_junction(std::uint32_t v) const { return begin_[v + 1] - begin_[v] != 2; }

  void trace_arcs() {
    std::vector<bool> done(t_.opposite.size());
    for (const bool from_junctions : {true, false}) {
      for (std::uint32_t v = 0; v < t_.x.size(); ++v) {
        if (is_junction(v) != from_junctions) continue;
        for (std::uint32_t i = begin_[v]; i < begin_[v + 1]; ++i) {
          if (!done[edges_[i]]) trace(edges_[i], v, done);
        }
      }
    }
  }

  void trace(std::uint32_t edge, std::uint32_t start, std::vector<bool>& done) {
    Arc arc;
    std::uint32_t v = start;
    for (std::uint32_t next = edge;;) {
      done[next] = true;
      const bool along = t_.vertex(next) == v;
      // The border of the picture has one side only.
      arc.half_edges.push_back(along || t_.opposite[next] == kNoIndex ? next : t_.opposite[next]);
      v = along ? t_.target(next) : t_.vertex(next);
      if (v == start || is_junction(v)) break;
      next = edges_[begin_[v]] == next ? edges_[begin_[v] + 1] : edges_[begin_[v]];
    }
    if (t_.vertex(arc.half_edges.front()) != start) {  // along the border, against its half edges
      std::reverse(arc.half_edges.begin(), arc.half_edges.end());
    }
    arc.left = region(arc.half_edges.front());
    arc.right = region(t_.opposite[arc.half_edges.front()]);
    arcs_.push_back(std::move(arc));
  }

  /// Where a border runs between nearly equal colours nobody can tell.
  double tolerance(const Arc& arc, const OutlineOptions& options) const {
    if (arc.right == kNoIndex) return options.tolerance;
    const Paint& left = p_.regions[arc.left].paint;
    const Paint& right = p_.regions[arc.right].paint;
    double squares = 0;
    for (const std::uint32_t h : arc.half_edges) {
      for (const Vec2 x : {t_.origin(h), t_.x[t_.target(h)]}) {
        double sum = 0;
        for (std::size_t c = 0; c < options.channels; ++c) {
          const double d = std::clamp(left.at(x, c), 0.0, 255.0) - std::clamp(right.at(x, c), 0.0, 255.0);
          sum += d * d;
        }
        squares = std::max(squares, sum);
      }
    }
    const double allowed = 0.5 * options.hidden / std::max(1.0, std::sqrt(squares));
    return std::max(options.tolerance, std::min(kFarthest, allowed));
  }

  std::vector<Curve> chain_of(const Arc& arc) const {
    std::vector<Curve> chain;
    FeaturePiece open;  // pieces of one half edge go together
    bool is_open = false;
    const auto close = [&] {
      if (!is_open) return;
      Curve c = part_of(sheets_.curve(open.half_edge), open.t0, open.t1);
      if (!chain.empty()) c[0] = chain.back()[3];
      chain.push_back(c);
      is_open = false;
    };
    for (const std::uint32_t h : arc.half_edges) {
      const std::uint32_t piece = t_.piece[h];
      if (piece == kNoIndex) {
        close();
        chain.push_back(straight(chain.empty() ? t_.origin(h) : chain.back()[3], t_.x[t_.target(h)]));
        continue;
      }
      const FeaturePiece& next = t_.pieces[piece];
      if (is_open && open.half_edge == next.half_edge && open.t1 == next.t0) {
        open.t1 = next.t1;
        continue;
      }
      close();
      open = next;
      is_open = true;
    }
    close();
    // The two sides of a feature agree up to rounding; ends are those of the vertices.
    chain.front()[0] = t_.origin(arc.half_edges.front());
    chain.back()[3] = t_.x[t_.target(arc.half_edges.back())];
    return chain;
  }

  std::vector<std::vector<Loop>> join_arcs() const {
    struct Way {
      std::uint32_t arc;
      bool reversed;
    };
    std::vector<std::multimap<std::uint32_t, Way>> ways(p_.regions.size());
    for (std::uint32_t i = 0; i < arcs_.size(); ++i) {
      const Arc& arc = arcs_[i];
      const std::uint32_t first = t_.vertex(arc.half_edges.front());
      const std::uint32_t last = t_.target(arc.half_edges.back());
      ways[arc.left].emplace(first, Way{i, false});
      if (arc.right != kNoIndex) ways[arc.right].emplace(last, Way{i, true});
    }
    std::vector<std::vector<Loop>> result(p_.regions.size());
    for (std::size_t r = 0; r < ways.size(); ++r) {
      auto& open = ways[r];
      while (!open.empty()) {
        Loop& outline = result[r].emplace_back();
        for (auto next = open.begin(); next != open.end();) {
          const Way way = next->second;
          open.erase(next);
          const Arc& arc = arcs_[way.arc];
          append(arc.curves, way.reversed, outline);
          const std::uint32_t end =
              way.reversed ? t_.vertex(arc.half_edges.front()) : t_.target(arc.half_edges.back());
          next = open.find(end);
        }
      }
    }
    return result;
  }

  static void append(const std::vector<Curve>& curves, bool reversed, Loop& outline) {
    if (!reversed) {
      outline.insert(outline.end(), curves.begin(), curves.end());
      return;
    }
    for (auto c = curves.rbegin(); c != curves.rend(); ++c) {
      outline.push_back({(*c)[3], (*c)[2], (*c)[1], (*c)[0]});
    }
  }

  const Sheets& sheets_;
  const Triangulation& t_;
  const Partition& p_;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> edges_;
  std::vector<Arc> arcs_;
};

}  // namespace

std::vector<std::vector<Loop>> outlines(const Tessellator& tessellator, const Triangulation& triangles,
                                        const Partition& partition, const OutlineOptions& options) {
  return Tracer(tessellator, triangles, partition).run(options);
}

}  // namespace knotreel::exporting
