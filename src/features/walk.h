// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "features/gradient.h"
#include "features/link_map.h"

namespace knotreel::features {

/// The smart routing of edge drawing: from an anchor both ways along the edge, each time to the strongest of
/// three neighbours. A walk ends where the gradient is too weak or of another edge, and before it touches
/// what is drawn or itself, so paths are clean from the start: of two pixels of a path that are neighbours
/// one follows the other.
class Walker {
 public:
  Walker(const GradientField& field, const LinkMap& map, double threshold);

  /// Pixels (of the map) in order; empty if the anchor lies beside something drawn.
  std::vector<int> walk(int anchor);

  /// No walk enters this pixel any more.
  void close(int pixel) { marks_[std::size_t(pixel)] = kClosed; }
  bool closed(int pixel) const { return marks_[std::size_t(pixel)] == kClosed; }

 private:
  static constexpr std::int32_t kClosed = -1;
  static constexpr int kNone = -1;  // for pixels
  static constexpr int kLeaves = -2;

  void extend(std::vector<int>& path, int step_x, int step_y);
  int next_pixel(int pixel, int step_x, int step_y) const;
  int strongest(int pixel, const int (&directions)[4], int count) const;
  bool in_margin(int pixel) const;
  bool same_edge(int a, int b) const;
  bool touches_path(int pixel, int end) const;
  std::size_t at(int pixel) const { return field_.at(map_.x(pixel), map_.y(pixel)); }

  const GradientField& field_;
  const LinkMap& map_;
  float threshold_;
  /// Of each pixel: stamp of the walk that was there last; even: still on its path, odd: left again.
  std::vector<std::int32_t> marks_;
  std::int32_t stamp_ = 0;
};

}  // namespace knotreel::features
