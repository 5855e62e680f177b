// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/join.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "knotreel/base/vec2.h"

namespace knotreel::features {
namespace {

/// A tip is joined to pixels up to so far away. Walks end two away from what they would touch; the rest is
/// gaps.
constexpr int kReach = 4;
/// Up to here there is no gap. To such pixels a chain may turn by up to 60 degrees, over gaps by 37 only.
constexpr double kContact = 2.9;
/// Chains that may meet in a node. More have no room around a pixel.
constexpr int kMostArms = 4;
/// The tip may be taken back by so many pixels: the last ones before a junction are often led astray.
constexpr std::size_t kMaxBack = 3;
/// The shortest way along chains from a tip to where it may be joined to its own chain.
constexpr int kShortestLoop = 8;

Vec2 vector_between(const LinkMap& map, int from, int to) {
  return {double(map.x(to) - map.x(from)), double(map.y(to) - map.y(from))};
}

int only_direction(const LinkMap& map, int tip) {
  for (int d = 0; d < 8; ++d) {
    if (map.linked(tip, d)) return d;
  }
  return 0;
}

/// Tip first, up to the next node.
std::vector<int> tail_of(const LinkMap& map, int tip) {
  return map.follow(tip, only_direction(map, tip), kShortestLoop + kMaxBack);
}

/// Pixels of a digital straight line, with both ends.
std::vector<int> straight_line(const LinkMap& map, int from, int to) {
  const Vec2 v = vector_between(map, from, to);
  const int steps = int(std::max(std::abs(v.x), std::abs(v.y)));
  std::vector<int> line;
  for (int k = 0; k <= steps; ++k) {
    const double t = double(k) / steps;
    line.push_back(
        map.index(map.x(from) + int(std::lround(t * v.x)), map.y(from) + int(std::lround(t * v.y))));
  }
  return line;
}

/// One way to join a tip.
struct Bridge {
  double cost = 0;
  std::size_t back = 0;  ///< pixels that the tip is taken back by
  int to = 0;
};

/// What has to go for a chain to be joined at q: the pixels from a free tip to q, if there is one so near
/// that it would be left over as a stub (walks around a closed contour overlap). Nothing if no chain may be
/// joined there.
std::optional<std::vector<int>> stub_at(const LinkMap& map, int q) {
  std::vector<int> stub;
  if (map.node(q)) {
    if (map.degree(q) >= kMostArms) return std::nullopt;
    return stub;
  }
  for (int d = 0; d < 8; ++d) {
    if (!map.linked(q, d)) continue;
    const std::vector<int> arm = map.follow(q, d, kNodeDistance);
    if (!map.node(arm.back())) continue;
    if (map.degree(arm.back()) != 1 || map.at_side(arm.back()) || !stub.empty()) return std::nullopt;
    stub = arm;
  }
  return stub;
}

/// So near along the chain that is to be joined that the loop would be too short.
bool is_own(const LinkMap& map, int q, int from) {
  const std::vector<int> own = map.reach(from, kShortestLoop - 1);
  return std::find(own.begin(), own.end(), q) != own.end();
}

/// Bridges from the tail taken back by `back` pixels to drawn pixels ahead of it.
void collect_bridges(const LinkMap& map, const std::vector<int>& tail, std::size_t back, Join join,
                     std::vector<Bridge>& bridges) {
  const int base = tail[back];
  const Vec2 heading = vector_between(map, tail[std::min(back + 4, tail.size() - 1)], base);
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const int x = map.x(base) + dx;
      const int y = map.y(base) + dy;
      if (x < 1 || y < 1 || x >= map.width() - 1 || y >= map.height() - 1) continue;
      const int q = map.index(x, y);
      if (!map.drawn(q)) continue;
      const Vec2 v{double(dx), double(dy)};
      const double lengths = norm(v) * norm(heading);
      const double ahead = dot(v, heading);
      const bool contact = norm(v) < kContact;
      if (lengths == 0 || (!contact && join == Join::kContacts)) continue;
      if (ahead < (contact ? 0.5 : 0.8) * lengths) continue;
      const double turn = 1 - ahead / lengths;
      bridges.push_back({norm(v) + double(back) + 2 * turn - (map.node(q) ? 1.5 : 0), back, q});
    }
  }
}

/// Draws the bridge, and takes it back if the map is not sound with it.
bool try_bridge(LinkMap& map, const std::vector<int>& tail, const Bridge& bridge) {
  const int from = tail[bridge.back];
  const std::optional<std::vector<int>> stub = stub_at(map, bridge.to);
  if (!stub || is_own(map, bridge.to, from)) return false;
  const std::vector<int> given_up(tail.begin(), tail.begin() + std::ptrdiff_t(bridge.back) + 1);
  const std::vector<int> line = straight_line(map, from, bridge.to);
  map.unlink_all(given_up);
  map.unlink_all(*stub);
  const bool free = std::none_of(line.begin() + 1, line.end() - 1, [&](int i) { return map.drawn(i); });
  if (free && map.drawn(from) && map.drawn(bridge.to)) {
    map.link_all(line);
    // A node that vanishes here no longer excuses neighbours within two steps of it.
    std::vector<int> touched = map.reach(line.front(), 3);
    const std::vector<int> beyond = map.reach(line.back(), 3);
    touched.insert(touched.end(), beyond.begin(), beyond.end());
    touched.insert(touched.end(), line.begin(), line.end());
    if (std::all_of(touched.begin(), touched.end(), [&](int i) { return map.sound(i); })) return true;
    map.unlink_all(line);
  }
  map.link_all(*stub);
  map.link_all(given_up);
  return false;
}

/// Draws `count` pixels from the tip on, the last of which, and only that, has to lie at a side, and at one
/// only.
bool run_to_side(LinkMap& map, int tip, int count, Vec2 slope) {
  std::vector<int> path{tip};
  for (int k = 1; k <= count; ++k) {
    const int x = map.x(tip) + int(std::lround(k * slope.x));
    const int y = map.y(tip) + int(std::lround(k * slope.y));
    if (x < 0 || y < 0 || x >= map.width() || y >= map.height()) return false;
    path.push_back(map.index(x, y));
    if (map.drawn(path.back()) || map.at_side(path.back()) != (k == count)) return false;
  }
  if (map.in_corner(path.back())) return false;
  map.link_all(path);
  if (std::all_of(path.begin(), path.end(), [&](int i) { return map.sound(i); })) return true;
  map.unlink_all(path);
  return false;
}

}  // namespace

bool join_tip(LinkMap& map, int tip, Join join) {
  if (map.degree(tip) != 1 || map.at_side(tip)) return false;
  const std::vector<int> tail = tail_of(map, tip);
  std::vector<Bridge> bridges;
  for (std::size_t back = 0; back <= kMaxBack && back + kNodeDistance < tail.size(); ++back) {
    collect_bridges(map, tail, back, join, bridges);
  }
  std::sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tie(a.cost, a.back, a.to) < std::tie(b.cost, b.back, b.to);
  });
  return std::any_of(bridges.begin(), bridges.end(),
                     [&](const Bridge& bridge) { return try_bridge(map, tail, bridge); });
}

bool extend_to_side(LinkMap& map, int tip) {
  if (map.degree(tip) != 1 || map.at_side(tip)) return false;
  const std::vector<int> tail = tail_of(map, tip);
  const Vec2 heading = vector_between(map, tail[std::min<std::size_t>(4, tail.size() - 1)], tip);
  const int gaps[4] = {map.width() - 1 - map.x(tip), map.height() - 1 - map.y(tip), map.x(tip), map.y(tip)};
  constexpr int kNearSide = 3;
  // The sides that it heads for, the most directly first.
  std::vector<std::pair<double, int>> sides;
  for (int s = 0; s < 4; ++s) {
    const double towards = heading.x * kStepX[2 * s] + heading.y * kStepY[2 * s];
    if (gaps[s] <= kNearSide && towards > 0.5 * norm(heading)) sides.emplace_back(-towards, s);
  }
  std::sort(sides.begin(), sides.end());
  for (const auto& [towards, s] : sides) {
    const Vec2 ahead{std::clamp(heading.x / -towards, -1.0, 1.0),
                     std::clamp(heading.y / -towards, -1.0, 1.0)};
    if (run_to_side(map, tip, gaps[s], ahead)) return true;
    // Near a corner of the picture, straight to one of its sides.
    if (run_to_side(map, tip, gaps[s], {double(kStepX[2 * s]), double(kStepY[2 * s])})) return true;
  }
  return false;
}

}  // namespace knotreel::features
