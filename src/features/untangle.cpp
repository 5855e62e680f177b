// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/untangle.h"

#include <algorithm>
#include <cmath>

namespace knotreel::features {
namespace {

struct Step {
  Vec2 a;
  Vec2 b;
  std::uint64_t pixel_a = 0;  // points of chains are the same if their pixels are
  std::uint64_t pixel_b = 0;
  StepIndex index;
};

std::size_t step_count(const Chain& chain) {
  return chain.points.size() - (chain.closed ? 0 : 1);
}

std::size_t end_of_step(const Chain& chain, std::size_t i) {
  return i + 1 == chain.points.size() ? 0 : i + 1;
}

std::vector<Step> all_steps(const FeatureChains& chains) {
  const auto pixel = [&](const ChainPoint& p) {
    return std::uint64_t(p.y) * std::uint64_t(chains.width) + std::uint64_t(p.x);
  };
  std::vector<Step> steps;
  for (std::uint32_t c = 0; c < chains.chains.size(); ++c) {
    const Chain& chain = chains.chains[c];
    for (std::uint32_t i = 0; i < step_count(chain); ++i) {
      const ChainPoint& p = chain.points[i];
      const ChainPoint& q = chain.points[end_of_step(chain, i)];
      steps.push_back({p.position, q.position, pixel(p), pixel(q), {c, i}});
    }
  }
  return steps;
}

bool within(double x, double a, double b) {
  return std::min(a, b) <= x && x <= std::max(a, b);
}

/// p lies on the line through a and b: is it between them?
bool between(Vec2 p, Vec2 a, Vec2 b) {
  return within(p.x, a.x, b.x) && within(p.y, a.y, b.y);
}

/// Closed segments have a point in common.
bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double abc = cross(b - a, c - a);
  const double abd = cross(b - a, d - a);
  const double cda = cross(d - c, a - c);
  const double cdb = cross(d - c, b - c);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(c, a, b)) || (abd == 0 && between(d, a, b)) || (cda == 0 && between(a, c, d)) ||
         (cdb == 0 && between(b, c, d));
}

/// Segments from a common point: one lies on the other.
bool fold(Vec2 common, Vec2 b, Vec2 d) {
  return cross(b - common, d - common) == 0 && dot(b - common, d - common) >= 0;
}

bool conflict(const Step& s, const Step& t) {
  if (s.pixel_a == t.pixel_a) return fold(s.a, s.b, t.b);
  if (s.pixel_a == t.pixel_b) return fold(s.a, s.b, t.a);
  if (s.pixel_b == t.pixel_a) return fold(s.b, s.a, t.b);
  if (s.pixel_b == t.pixel_b) return fold(s.b, s.a, t.a);
  return segments_meet(s.a, s.b, t.a, t.b);
}

/// Lists of steps by square cells that their bounding boxes touch, in one array.
class Cells {
 public:
  Cells(const FeatureChains& chains, const std::vector<Step>& steps)
      : columns_(chains.width / kSize + 1), rows_(chains.height / kSize + 1) {
    starts_.assign(std::size_t(columns_) * std::size_t(rows_) + 1, 0);
    for (const Step& s : steps) {
      for_cells(s, [&](std::size_t cell) { ++starts_[cell + 1]; });
    }
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    members_.resize(starts_.back());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::uint32_t s = 0; s < steps.size(); ++s) {
      for_cells(steps[s], [&](std::size_t cell) { members_[next[cell]++] = s; });
    }
  }

  template <typename Body>
  void for_pairs(Body body) const {
    for (std::size_t cell = 0; cell + 1 < starts_.size(); ++cell) {
      for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
        for (std::uint32_t j = i + 1; j < starts_[cell + 1]; ++j) body(members_[i], members_[j]);
      }
    }
  }

 private:
  static constexpr int kSize = 4;  // px; steps are about 1.4 px long

  template <typename Body>
  void for_cells(const Step& s, Body body) const {
    const auto cell_of = [](double p, int count) {
      return std::clamp(int(std::floor(p / kSize)), 0, count - 1);
    };
    const int last_x = cell_of(std::max(s.a.x, s.b.x), columns_);
    const int last_y = cell_of(std::max(s.a.y, s.b.y), rows_);
    for (int y = cell_of(std::min(s.a.y, s.b.y), rows_); y <= last_y; ++y) {
      for (int x = cell_of(std::min(s.a.x, s.b.x), columns_); x <= last_x; ++x) {
        body(std::size_t(y) * std::size_t(columns_) + std::size_t(x));
      }
    }
  }

  int columns_;
  int rows_;
  std::vector<std::uint32_t> starts_;
  std::vector<std::uint32_t> members_;
};

bool same_pixel(const ChainPoint& a, const ChainPoint& b) {
  return a.x == b.x && a.y == b.y;
}

/// Ends of chains at one node move together.
void share_nodes(FeatureChains& chains, const Positions& target, const std::vector<ChainPoint>& moved) {
  if (moved.empty()) return;
  for (std::size_t c = 0; c < chains.chains.size(); ++c) {
    Chain& chain = chains.chains[c];
    if (chain.closed) continue;
    for (const std::size_t i : {std::size_t{0}, chain.points.size() - 1}) {
      const bool is_moved = std::any_of(moved.begin(), moved.end(),
                                        [&](const ChainPoint& p) { return same_pixel(p, chain.points[i]); });
      if (is_moved) chain.points[i].position = target[c][i];
    }
  }
}

/// Takes the ends of steps to their places in `target`. @return whether that changed anything
bool take_back(FeatureChains& chains, const std::vector<StepIndex>& steps, const Positions& target) {
  bool changed = false;
  std::vector<ChainPoint> nodes;
  for (const StepIndex& s : steps) {
    Chain& chain = chains.chains[s.chain];
    for (const std::size_t i : {std::size_t{s.point}, end_of_step(chain, s.point)}) {
      ChainPoint& p = chain.points[i];
      if (p.position == target[s.chain][i]) continue;
      p.position = target[s.chain][i];
      changed = true;
      if (!chain.closed && (i == 0 || i + 1 == chain.points.size())) nodes.push_back(p);
    }
  }
  share_nodes(chains, target, nodes);
  return changed;
}

}  // namespace

Positions positions_of(const FeatureChains& chains) {
  Positions positions;
  for (const Chain& chain : chains.chains) {
    auto& list = positions.emplace_back();
    for (const ChainPoint& p : chain.points) list.push_back(p.position);
  }
  return positions;
}

Positions pixel_centres_of(const FeatureChains& chains) {
  Positions positions;
  for (const Chain& chain : chains.chains) {
    auto& list = positions.emplace_back();
    for (const ChainPoint& p : chain.points) list.push_back({p.x + 0.5, p.y + 0.5});
  }
  return positions;
}

std::vector<StepIndex> crossing_steps(const FeatureChains& chains) {
  const std::vector<Step> steps = all_steps(chains);
  std::vector<std::uint8_t> crossing(steps.size(), 0);
  Cells(chains, steps).for_pairs([&](std::uint32_t i, std::uint32_t j) {
    if (conflict(steps[i], steps[j])) crossing[i] = crossing[j] = 1;
  });
  std::vector<StepIndex> result;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    if (crossing[s] || steps[s].a == steps[s].b) result.push_back(steps[s].index);
  }
  return result;
}

void untangle(FeatureChains& chains, const Positions& before) {
  // Each round takes a point back for good, so this ends; few rounds are usual.
  while (true) {
    const std::vector<StepIndex> steps = crossing_steps(chains);
    if (steps.empty()) return;
    if (!take_back(chains, steps, before)) break;
  }
  const Positions centres = pixel_centres_of(chains);
  while (true) {
    const std::vector<StepIndex> steps = crossing_steps(chains);
    if (steps.empty() || !take_back(chains, steps, centres)) return;
  }
}

}  // namespace knotreel::features
