// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace knotreel::features {

/// Steps to the eight neighbours, clockwise on the screen from the right; odd ones are diagonal, and d ^ 4 is
/// the way back.
inline constexpr int kStepX[8] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int kStepY[8] = {0, 1, 1, 1, 0, -1, -1, -1};

/// The drawing of all chains: for each pixel, which of its eight neighbours come next to it on a chain. With
/// that alone chains can be split, joined and removed without book-keeping: a node is a pixel that has not
/// exactly two links. Pixels are numbers, with a margin of one pixel around the picture.
class LinkMap {
 public:
  LinkMap(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int index(int x, int y) const { return (y + 1) * stride_ + x + 1; }
  int x(int i) const { return i % stride_ - 1; }
  int y(int i) const { return i / stride_ - 1; }
  int size() const { return int(links_.size()); }
  int neighbour(int i, int direction) const { return i + step_[direction]; }
  /// At a side of the picture.
  bool at_side(int i) const { return x(i) == 0 || y(i) == 0 || x(i) == width_ - 1 || y(i) == height_ - 1; }

  bool in_corner(int i) const {
    return (x(i) == 0 || x(i) == width_ - 1) && (y(i) == 0 || y(i) == height_ - 1);
  }

  bool drawn(int i) const { return links_[std::size_t(i)] != 0; }
  bool linked(int i, int direction) const { return (links_[std::size_t(i)] >> direction & 1) != 0; }
  int degree(int i) const { return kDegrees[links_[std::size_t(i)]]; }
  bool node(int i) const { return drawn(i) && degree(i) != 2; }
  /// Some pixel of the 3x3 block around i is drawn.
  bool crowded(int i) const;

  /// Pixels must be neighbours.
  void link(int a, int b);
  void unlink(int a, int b);
  void link_all(const std::vector<int>& path);
  void unlink_all(const std::vector<int>& path);

  /// The pixels within so many steps along chains, itself first.
  std::vector<int> reach(int i, int steps) const;
  /// From i along its link in a direction up to the next node, or until i or `limit` points are reached.
  std::vector<int> follow(int i, int direction, std::size_t limit) const;

  /// The promises of FeatureChains hold at this pixel: neighbours that are drawn are linked to it or within
  /// two steps of a node that it is within two steps of, and its diagonal steps cross no others.
  bool sound(int i) const;

 private:
  /// Number of bits; the instruction for it is not on all machines.
  static constexpr std::array<std::int8_t, 256> kDegrees = [] {
    std::array<std::int8_t, 256> result{};
    for (unsigned i = 0; i < 256; ++i) result[i] = std::int8_t(std::popcount(i));
    return result;
  }();

  bool share_node(int a, int b) const;

  int width_;
  int height_;
  int stride_;
  int step_[8];
  std::vector<std::uint8_t> links_;
};

/// Direction of the step between neighbours.
int direction_between(const LinkMap& map, int from, int to);

}  // namespace knotreel::features
