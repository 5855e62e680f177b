#include "features/prune.h"

#include <algorithm>
#include <array>
#include <limits>

namespace knotreel::features {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
/// Closed chains have at least so many points, see chains.h.
constexpr double kLeastClosed = 8;

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

/// What was a junction of three may leave two arms that touch beside it.
void straighten(LinkMap& map, int i) {
  if (map.degree(i) != 2) return;
  const auto [a, b] = two_neighbours(map, i);
  const int d = direction_between(map, a, b);
  if (d < 0 || map.linked(a, d)) return;
  map.unlink(i, a);
  map.unlink(i, b);
  map.link(a, b);
}

void erase(LinkMap& map, const Stretch& stretch) {
  map.unlink_all(stretch.pixels);
  if (stretch.closed) {
    map.unlink(stretch.pixels.back(), stretch.pixels.front());
  } else {
    straighten(map, stretch.pixels.front());
    straighten(map, stretch.pixels.back());
  }
}

bool too_short(const LinkMap& map, const Stretch& stretch, double min_length) {
  const auto points = double(stretch.pixels.size());
  if (stretch.closed) return points < std::max(min_length, kLeastClosed);
  const bool free = map.degree(stretch.pixels.front()) == 1 || map.degree(stretch.pixels.back()) == 1;
  return free && points < min_length;
}

/// Removing chains can, in principle, leave neighbours without the node that excused them: the shorter chain
/// goes.
bool drop_unsound(LinkMap& map, int i) {
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
  erase(map, *worst);
  return true;
}

}  // namespace

Stretch stretch_from(const LinkMap& map, int i, int direction) {
  Stretch stretch{map.follow(i, direction, kNoLimit), false};
  if (!map.node(i)) {
    stretch.closed = true;
    stretch.pixels.pop_back();
  }
  return stretch;
}

bool drop_if_short(LinkMap& map, int i, double min_length) {
  if (!map.drawn(i) || map.node(i)) return false;
  const Stretch stretch = stretch_through(map, i);
  if (!too_short(map, stretch, min_length)) return false;
  erase(map, stretch);
  return true;
}

void prune(LinkMap& map, double min_length) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (int i = 0; i < map.size(); ++i) {
      if (map.degree(i) != 1) continue;
      const Stretch stretch = stretch_from(map, i, first_direction(map, i));
      if (!too_short(map, stretch, min_length)) continue;
      erase(map, stretch);
      changed = true;
    }
    if (changed) continue;
    for (int i = 0; i < map.size(); ++i) {
      if (map.drawn(i) && drop_unsound(map, i)) changed = true;
    }
  }
}

}  // namespace knotreel::features
