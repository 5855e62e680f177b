// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/prune.h"

#include <array>
#include <limits>

namespace knotreel::features {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
/// Closed chains have at least so many points, see chains.h.
constexpr double kLeastClosed = 8;
/// Of the weight that other chains need.
constexpr double kShareOfLinks = 0.5;

/// The linked neighbours, as many as fit.
std::array<int, 2> two_neighbours(const LinkMap& map, int i) {
  std::array<int, 2> result{i, i};
  std::size_t count = 0;
  for (int d = 0; d < 8 && count < 2; ++d) {
    if (map.linked(i, d)) result[count++] = map.neighbour(i, d);
  }
  return result;
}

int first_direction(const LinkMap& map, int i) {
  for (int d = 0; d < 8; ++d) {
    if (map.linked(i, d)) return d;
  }
  return -1;
}

/// From node to node through a pixel that is none.
Stretch stretch_through(const LinkMap& map, int i) {
  const std::vector<int> half = map.follow(i, first_direction(map, i), kNoLimit);
  if (half.back() == i) return stretch_from(map, i, first_direction(map, i));
  const int end = half.back();
  return stretch_from(map, end, direction_between(map, end, half[half.size() - 2]));
}

/// What was a junction of three may leave two arms that touch beside it. @return a pixel of the chain through
/// i
int straighten(LinkMap& map, int i) {
  if (map.degree(i) != 2) return i;
  const auto [a, b] = two_neighbours(map, i);
  const int d = direction_between(map, a, b);
  if (d < 0 || map.linked(a, d)) return i;
  map.unlink(i, a);
  map.unlink(i, b);
  map.link(a, b);
  return a;
}

/// @return pixels of the chains that it was joined to
std::vector<int> erase(LinkMap& map, const Stretch& stretch) {
  map.unlink_all(stretch.pixels);
  if (stretch.closed) {
    map.unlink(stretch.pixels.back(), stretch.pixels.front());
    return {};
  }
  const int first = straighten(map, stretch.pixels.front());
  return {first, straighten(map, stretch.pixels.back())};
}

/// Also what was joined to it and is not worth enough without: a loop that hung on it, say, is a closed chain
/// now.
void erase_all(LinkMap& map, const Stretch& stretch, const Worth& worth) {
  for (const int rest : erase(map, stretch)) drop_if_worthless(map, rest, worth);
}

/// Removing chains can, in principle, leave neighbours without the node that excused them: the shorter chain
/// goes.
bool drop_unsound(LinkMap& map, int i, const Worth& worth) {
  if (map.sound(i)) return false;
  const Stretch* worst = nullptr;
  std::vector<Stretch> stretches;
  for (int d = 0; d < 8; ++d) {
    const int other = map.neighbour(i, d);
    for (const int end : {i, other}) {
      if (!map.drawn(end)) continue;
      stretches.push_back(map.node(end) ? stretch_from(map, end, first_direction(map, end))
                                        : stretch_through(map, end));
    }
  }
  for (const Stretch& s : stretches) {
    if (worst == nullptr || s.pixels.size() < worst->pixels.size()) worst = &s;
  }
  erase_all(map, *worst, worth);
  return true;
}

}  // namespace

bool Worth::enough(const LinkMap& map, const Stretch& stretch) const {
  const bool free = map.degree(stretch.pixels.front()) == 1 || map.degree(stretch.pixels.back()) == 1;
  const bool link = !stretch.closed && !free;
  const auto points = double(stretch.pixels.size());
  if (!link && points < least_points) return false;
  if (stretch.closed && points < kLeastClosed) return false;
  double weight = 0;
  for (const int i : stretch.pixels) weight += double{field.magnitude[field.at(map.x(i), map.y(i))]};
  return weight >= (link ? kShareOfLinks : 1) * least_weight;
}

Stretch stretch_from(const LinkMap& map, int i, int direction) {
  Stretch stretch{map.follow(i, direction, kNoLimit), false};
  if (!map.node(i)) {
    stretch.closed = true;
    stretch.pixels.pop_back();
  }
  return stretch;
}

bool drop_if_worthless(LinkMap& map, int i, const Worth& worth) {
  if (!map.drawn(i) || map.node(i)) return false;
  const Stretch stretch = stretch_through(map, i);
  if (worth.enough(map, stretch)) return false;
  erase_all(map, stretch, worth);
  return true;
}

void drop_spurs(LinkMap& map, const Worth& worth) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (int i = 0; i < map.size(); ++i) {
      if (map.degree(i) != 1) continue;
      const Stretch stretch = stretch_from(map, i, first_direction(map, i));
      if (worth.enough(map, stretch)) continue;
      erase_all(map, stretch, worth);
      changed = true;
    }
  }
}

void prune(LinkMap& map, const Worth& worth) {
  bool changed = true;
  while (changed) {
    changed = false;
    drop_spurs(map, worth);
    for (int i = 0; i < map.size(); ++i) {
      if (map.drawn(i) && drop_unsound(map, i, worth)) changed = true;
    }
  }
}

}  // namespace knotreel::features
