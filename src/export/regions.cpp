// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <unordered_map>

namespace knotreel::exporting {

namespace {

// A region that is so many times as large as the other one keeps its paint when they are put together.
constexpr std::uint32_t kMuchLarger = 16;
constexpr std::size_t kStepsPerCheck = 1 << 16;
// Triangles of what may be too thin to be seen. What has more is large, and to go through it for each of many
// neighbours that it has swallowed one after the other could take for ever.
constexpr std::uint32_t kMostThin = 4096;

class Merger {
 public:
  Merger(const Triangulation& triangles, const RegionOptions& options)
      : t_(triangles), options_(options), groups_(triangles.triangles.size()) {
    for (std::uint32_t i = 0; i < groups_.size(); ++i) {
      Group& g = groups_[i];
      g.parent = g.next = g.last = i;
      const Corners corners = corners_of(t_, i, options_.first, options_.count);
      g.moments = moments_of(corners.x, corners.colour);
      const PaintFit fit = fit_paint(g.moments);
      g.paint = fit.paint;
      g.squared_error = fit.squared_error;
    }
  }

  Partition run() {
    merge_what_fits();
    find_flat();
    absorb_thin();
    return partition();
  }

 private:
  struct Group {
    std::uint32_t parent = 0;
    std::uint32_t next = kNoIndex;  ///< triangles of a group are a list that begins at its root
    std::uint32_t last = 0;
    std::uint32_t size = 1;
    std::uint32_t fitted = 1;  ///< its size when a paint was last fitted
    std::uint32_t version = 0;
    Moments moments;
    Paint paint;
    bool flat = false;
    double squared_error = 0;
  };
  struct Candidate {
    double loss;
    std::uint32_t half_edge;
    std::uint32_t version;  ///< of both groups, summed up
    bool operator<(const Candidate& other) const {
      return loss != other.loss ? loss > other.loss : half_edge > other.half_edge;
    }
  };

  double level(std::uint32_t corner, std::size_t c) const {
    return double{t_.colour[corner][options_.first + c]};
  }

  std::uint32_t find(std::uint32_t i) {
    while (groups_[i].parent != i) i = groups_[i].parent = groups_[groups_[i].parent].parent;
    return i;
  }

  double loss(std::uint32_t a, std::uint32_t b) const {
    Moments sum = groups_[a].moments;
    sum += groups_[b].moments;
    return fit_paint(sum).squared_error - groups_[a].squared_error - groups_[b].squared_error;
  }

  bool fits(const Paint& paint, std::uint32_t root) const {
    for (std::uint32_t i = root; i != kNoIndex; i = i == groups_[root].last ? kNoIndex : groups_[i].next) {
      for (std::size_t c = 0; c < options_.count; ++c) {
        if (!fits(paint, i, c)) return false;
      }
    }
    return true;
  }

  /// In one triangle. Outside 0..255 colours may differ as they like, but only where the whole triangle is:
  /// one that comes out of it would come out elsewhere.
  bool fits(const Paint& paint, std::uint32_t triangle, std::size_t c) const {
    const double tolerance = options_.colour_tolerance;
    bool near = true, black = true, white = true;
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
      const double painted = paint.at(t_.origin(h), c);
      const double wanted = level(h, c);
      near = near && std::abs(painted - wanted) <= tolerance;
      black = black && std::max(painted, wanted) <= 0.5 * tolerance;
      white = white && std::min(painted, wanted) >= 255 - 0.5 * tolerance;
    }
    return near || black || white;
  }

  /// A paint for both, if there is one. That of the large one is fitted anew when the small one counts, and
  /// whenever it has become twice as large, so that triangles are looked at a few times each.
  bool find_paint(std::uint32_t a, std::uint32_t b, Paint& paint, std::uint32_t& fitted) const {
    const Group& large = groups_[a];
    const Group& small = groups_[b];
    const std::uint32_t size = large.size + small.size;
    fitted = large.fitted;
    if (large.size < kMuchLarger * small.size || size >= 2 * large.fitted) {
      Moments sum = large.moments;
      sum += small.moments;
      paint = fit_paint(sum).paint;
      fitted = size;
      if (fits(paint, b) && fits(paint, a)) return true;
    }
    paint = large.paint;
    return fits(paint, b);
  }

  void join(std::uint32_t a, std::uint32_t b) {
    Group& large = groups_[a];
    Group& small = groups_[b];
    small.parent = a;
    groups_[large.last].next = b;
    large.last = small.last;
    large.size += small.size;
    large.moments += small.moments;
    ++large.version;
    large.version += small.version;
    large.squared_error = fit_paint(large.moments).squared_error;
  }

  void merge_what_fits() {
    std::priority_queue<Candidate> queue;
    for (std::uint32_t h = 0; h < t_.opposite.size(); ++h) {
      if (t_.opposite[h] != kNoIndex && h < t_.opposite[h]) {
        queue.push({loss(h / 3, t_.opposite[h] / 3), h, 0});
      }
    }
    // Pairs that do not fit are not tried again by way of another edge until one of them has changed.
    std::unordered_map<std::uint64_t, std::uint32_t> refused;
    for (std::size_t step = 0; !queue.empty(); ++step) {
      if (step % kStepsPerCheck == 0 && options_.checkpoint) options_.checkpoint();
      const Candidate top = queue.top();
      queue.pop();
      std::uint32_t a = find(top.half_edge / 3);
      std::uint32_t b = find(t_.opposite[top.half_edge] / 3);
      if (a == b) continue;
      const std::uint32_t version = groups_[a].version + groups_[b].version;
      if (version != top.version) {
        queue.push({loss(a, b), top.half_edge, version});
        continue;
      }
      if (groups_[a].size < groups_[b].size || (groups_[a].size == groups_[b].size && b < a)) std::swap(a, b);
      const std::uint64_t pair = (std::uint64_t{a} << 32) | b;
      if (const auto known = refused.find(pair); known != refused.end() && known->second == version) continue;
      Paint paint;
      std::uint32_t fitted = 0;
      if (!find_paint(a, b, paint, fitted)) {
        refused[pair] = version;
        continue;
      }
      join(a, b);
      groups_[a].paint = paint;
      groups_[a].fitted = fitted;
    }
  }

  /// One colour where that will do.
  void find_flat() {
    for (std::uint32_t root = 0; root < groups_.size(); ++root) {
      Group& g = groups_[root];
      if (g.parent != root || !(g.moments.area > 0)) continue;
      Paint paint = g.paint;
      for (std::size_t c = 0; c < options_.count; ++c) paint.colour[c] = g.moments.colour[c] / g.moments.area;
      paint.slope = {};
      g.flat = fits(paint, root);
      if (g.flat) g.paint = paint;
    }
  }

  /// What can hardly be seen goes to the neighbour whose paint is most like it: a strip of width w that is
  /// off by e changes a pixel by e w.
  void absorb_thin() {
    std::vector<double> outline(groups_.size(), 0.0);
    for (std::uint32_t h = 0; h < t_.opposite.size(); ++h) {
      const std::uint32_t o = t_.opposite[h];
      if (o == kNoIndex || find(h / 3) != find(o / 3)) outline[find(h / 3)] += length(h);
    }
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t root = 0; root < groups_.size(); ++root) {
      if (groups_[root].parent == root) order.emplace_back(groups_[root].moments.area, root);
    }
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i % kMostThin == 0 && options_.checkpoint) options_.checkpoint();
      const std::uint32_t root = order[i].second;
      if (groups_[root].size > kMostThin) continue;
      const Neighbour n = most_alike(root);
      if (n.root == kNoIndex) continue;
      const double width = 2 * groups_[root].moments.area / outline[root];
      if (width * n.error > options_.hidden) continue;
      outline[n.root] += outline[root] - 2 * n.shared;
      join(n.root, root);
    }
  }

  struct Neighbour {
    std::uint32_t root = kNoIndex;
    double error = 0;   ///< root mean square of what its paint is off in the region, all channels together
    double shared = 0;  ///< length of the border between them
  };

  double length(std::uint32_t h) const { return norm(t_.x[t_.target(h)] - t_.origin(h)); }

  Neighbour most_alike(std::uint32_t root) {
    std::map<std::uint32_t, double> shared;
    for (std::uint32_t i = root; i != kNoIndex; i = i == groups_[root].last ? kNoIndex : groups_[i].next) {
      for (std::uint32_t h = 3 * i; h < 3 * i + 3; ++h) {
        if (t_.opposite[h] == kNoIndex) continue;
        const std::uint32_t other = find(t_.opposite[h] / 3);
        if (other != root) shared[other] += length(h);
      }
    }
    Neighbour best;
    for (const auto& [other, length] : shared) {
      const double error = root_mean_square(groups_[other].paint, groups_[root].moments);
      if (best.root == kNoIndex || error < best.error) best = {other, error, length};
    }
    return best;
  }

  Partition partition() {
    Partition result;
    result.region_of.resize(groups_.size());
    std::vector<std::uint32_t> number(groups_.size(), kNoIndex);
    for (std::uint32_t i = 0; i < groups_.size(); ++i) {
      const std::uint32_t root = find(i);
      if (number[root] == kNoIndex) {
        number[root] = static_cast<std::uint32_t>(result.regions.size());
        result.regions.push_back(region(root));
      }
      result.region_of[i] = number[root];
    }
    return result;
  }

  Region region(std::uint32_t root) const {
    const Group& g = groups_[root];
    Region r;
    r.paint = g.paint;
    r.area = g.moments.area;
    r.flat = g.flat;
    r.from = INFINITY;
    r.to = -INFINITY;
    for (std::uint32_t i = root; i != kNoIndex; i = i == g.last ? kNoIndex : groups_[i].next) {
      for (std::uint32_t h = 3 * i; h < 3 * i + 3; ++h) {
        const double s = dot(r.paint.direction, t_.origin(h) - r.paint.centre);
        r.from = std::min(r.from, s);
        r.to = std::max(r.to, s);
      }
    }
    return r;
  }

  const Triangulation& t_;
  const RegionOptions& options_;
  std::vector<Group> groups_;
};

}  // namespace

Partition merge_triangles(const Triangulation& triangles, const RegionOptions& options) {
  return Merger(triangles, options).run();
}

}  // namespace knotreel::exporting
