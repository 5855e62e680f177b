// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/link_map.h"

#include <algorithm>

namespace knotreel::features {

LinkMap::LinkMap(int width, int height)
    : width_(width),
      height_(height),
      stride_(width + 2),
      links_(std::size_t(stride_) * std::size_t(height + 2), 0) {
  for (int d = 0; d < 8; ++d) step_[d] = kStepY[d] * stride_ + kStepX[d];
}

bool LinkMap::crowded(int i) const {
  const std::uint8_t* p = links_.data() + i;
  const std::uint8_t* above = p - stride_;
  const std::uint8_t* below = p + stride_;
  return (above[-1] | above[0] | above[1] | p[-1] | p[0] | p[1] | below[-1] | below[0] | below[1]) != 0;
}

int direction_between(const LinkMap& map, int from, int to) {
  for (int d = 0; d < 8; ++d) {
    if (map.neighbour(from, d) == to) return d;
  }
  return -1;
}

void LinkMap::link(int a, int b) {
  const int d = direction_between(*this, a, b);
  links_[std::size_t(a)] |= std::uint8_t(1 << d);
  links_[std::size_t(b)] |= std::uint8_t(1 << (d ^ 4));
}

void LinkMap::unlink(int a, int b) {
  const int d = direction_between(*this, a, b);
  links_[std::size_t(a)] &= std::uint8_t(~(1 << d));
  links_[std::size_t(b)] &= std::uint8_t(~(1 << (d ^ 4)));
}

void LinkMap::link_all(const std::vector<int>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) link(path[i - 1], path[i]);
}

void LinkMap::unlink_all(const std::vector<int>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) unlink(path[i - 1], path[i]);
}

std::vector<int> LinkMap::reach(int i, int steps) const {
  std::vector<int> found{i};
  std::size_t begin = 0;
  for (int step = 0; step < steps; ++step) {
    const std::size_t end = found.size();
    for (; begin < end; ++begin) {
      for (int d = 0; d < 8; ++d) {
        if (!linked(found[begin], d)) continue;
        const int next = neighbour(found[begin], d);
        if (std::find(found.begin(), found.end(), next) == found.end()) found.push_back(next);
      }
    }
  }
  return found;
}

std::vector<int> LinkMap::follow(int i, int direction, std::size_t limit) const {
  std::vector<int> path{i};
  while (path.size() < limit) {
    const int next = neighbour(path.back(), direction);
    path.push_back(next);
    if (next == i || node(next)) break;
    // The other of the two links.
    const int rest = links_[std::size_t(next)] & ~(1 << (direction ^ 4));
    direction = std::countr_zero(unsigned(rest));
  }
  return path;
}

bool LinkMap::share_node(int a, int b) const {
  for (const int n : reach(a, 2)) {
    if (!node(n)) continue;
    const std::vector<int> around = reach(n, 2);
    if (std::find(around.begin(), around.end(), b) != around.end()) return true;
  }
  return false;
}

bool LinkMap::sound(int i) const {
  const unsigned links = links_[std::size_t(i)];
  for (int d = 0; d < 8; ++d) {
    const int other = neighbour(i, d);
    if (!drawn(other)) continue;
    if ((links >> d & 1) == 0) {
      if (!share_node(i, other)) return false;
    } else if (d % 2 == 1) {
      // The other two pixels of the square, and the step from one to the other.
      if (linked(neighbour(i, d - 1), (d + 2) % 8)) return false;
    }
  }
  return true;
}

}  // namespace knotreel::features
