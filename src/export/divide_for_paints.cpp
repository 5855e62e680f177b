// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/divide_for_paints.h"

#include <cmath>

#include "export/paint.h"
#include "export/patch_stream.h"

namespace knotreel::exporting {

namespace {

constexpr double kShortestHalfEdge = 1;  // pixels of the picture
constexpr std::size_t kTrianglesPerCheck = 1 << 16;

class Divider {
 public:
  Divider(Triangulation& triangles, std::size_t channels, double tolerance, std::uint64_t max_triangles)
      : t_(triangles), channels_(channels), tolerance_(tolerance), budget_(max_triangles) {
    budget_.spend(t_.triangles.size());
  }

  void run(const std::function<void()>& checkpoint) {
    std::vector<std::uint32_t> open(t_.triangles.size());
    for (std::uint32_t i = 0; i < open.size(); ++i) open[i] = i;
    for (std::size_t step = 0; !open.empty(); ++step) {
      if (step % kTrianglesPerCheck == 0 && checkpoint) checkpoint();
      const std::uint32_t i = open.back();
      open.pop_back();
      const std::uint32_t h = longest(i);
      if (length(h) < kShortestHalfEdge || has_paint(i)) continue;
      halve(h, open);
    }
  }

 private:
  double length(std::uint32_t h) const { return norm(t_.x[t_.target(h)] - t_.origin(h)); }

  std::uint32_t longest(std::uint32_t i) const {
    std::uint32_t best = 3 * i;
    for (std::uint32_t h = 3 * i + 1; h < 3 * i + 3; ++h) {
      if (length(h) > length(best)) best = h;
    }
    return best;
  }

  bool has_paint(std::uint32_t i) const {
    const Corners corners = corners_of(t_, i, 0, channels_);
    const Paint paint = fit_paint(moments_of(corners.x, corners.colour)).paint;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < channels_; ++c) {
        if (std::abs(paint.at(corners.x[k], c) - corners.colour[k][c]) > tolerance_) return false;
      }
    }
    return true;
  }

  void halve(std::uint32_t h, std::vector<std::uint32_t>& open) {
    const auto middle = static_cast<std::uint32_t>(t_.x.size());
    t_.x.push_back(0.5 * (t_.origin(h) + t_.x[t_.target(h)]));
    const std::uint32_t o = t_.opposite[h];
    const std::uint32_t far = halve_side(h, middle, open);
    if (o == kNoIndex) return;
    const std::uint32_t other = halve_side(o, middle, open);
    connect(h, other);
    connect(o, far);
  }

  void connect(std::uint32_t h, std::uint32_t o) {
    t_.opposite[h] = o;
    t_.opposite[o] = h;
  }

  /// The triangle of h keeps the half at its origin. @returns the half edge of the new triangle beyond.
  std::uint32_t halve_side(std::uint32_t h, std::uint32_t middle, std::vector<std::uint32_t>& open) {
    budget_.spend(1);
    const std::uint32_t i = h / 3;
    const std::uint32_t next = 3 * i + (h + 1) % 3;
    const std::uint32_t last = 3 * i + (h + 2) % 3;
    const auto added = static_cast<std::uint32_t>(t_.triangles.size());
    std::array<float, 4> colour{};
    for (std::size_t c = 0; c < 4; ++c) colour[c] = 0.5F * (t_.colour[h][c] + t_.colour[next][c]);
    // (middle, target, apex)
    t_.triangles.push_back({middle, t_.vertex(next), t_.vertex(last)});
    t_.colour.insert(t_.colour.end(), {colour, t_.colour[next], t_.colour[last]});
    t_.opposite.insert(t_.opposite.end(), {kNoIndex, kNoIndex, kNoIndex});
    t_.piece.insert(t_.piece.end(), {kNoIndex, t_.piece[next], kNoIndex});
    if (t_.opposite[next] != kNoIndex) connect(3 * added + 1, t_.opposite[next]);
    // What stays: (origin, middle, apex)
    t_.triangles[i][next % 3] = middle;
    t_.colour[next] = colour;
    t_.piece[next] = kNoIndex;
    connect(next, 3 * added + 2);
    if (const std::uint32_t piece = t_.piece[h]; piece != kNoIndex) {
      FeaturePiece second = t_.pieces[piece];
      second.t0 = t_.pieces[piece].t1 = 0.5 * (second.t0 + second.t1);
      t_.piece[3 * added] = static_cast<std::uint32_t>(t_.pieces.size());
      t_.pieces.push_back(second);
    }
    open.push_back(i);
    open.push_back(added);
    return 3 * added;
  }

  Triangulation& t_;
  std::size_t channels_;
  double tolerance_;
  TriangleBudget budget_;
};

}  // namespace

void divide_for_paints(Triangulation& triangles, std::size_t channels, double tolerance,
                       std::uint64_t max_triangles, const std::function<void()>& checkpoint) {
  Divider(triangles, channels, tolerance, max_triangles).run(checkpoint);
}

}  // namespace knotreel::exporting
