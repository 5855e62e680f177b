// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/chain_defects.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "features/untangle.h"

namespace knotreel::features {
namespace {

using Defect = std::optional<std::string>;

std::string at(const ChainPoint& p) {
  return " at pixel (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ")";
}

bool neighbours(const ChainPoint& a, const ChainPoint& b) {
  return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && (a.x != b.x || a.y != b.y);
}

Defect check_point(const FeatureChains& chains, const ChainPoint& p) {
  if (p.x < 0 || p.y < 0 || p.x >= chains.width || p.y >= chains.height)
    return "a point lies outside" + at(p);
  const bool near = std::abs(p.position.x - p.x - 0.5) <= 1 && std::abs(p.position.y - p.y - 0.5) <= 1;
  if (!near) return "a position is more than a pixel away" + at(p);
  return {};
}

bool at_side(const FeatureChains& chains, const ChainPoint& p) {
  return p.x == 0 || p.y == 0 || p.x == chains.width - 1 || p.y == chains.height - 1;
}

/// What can be seen of one chain alone.
Defect check_chain(const FeatureChains& chains, const Chain& chain) {
  const std::size_t n = chain.points.size();
  if (n < 2) return "a chain has fewer than two points";
  if (chain.closed && n < 8) return "a closed chain has fewer than eight points" + at(chain.points[0]);
  for (const ChainPoint& p : chain.points) {
    if (Defect defect = check_point(chains, p)) return defect;
  }
  for (std::size_t i = 1; i < n; ++i) {
    if (!neighbours(chain.points[i - 1], chain.points[i])) return "a chain jumps" + at(chain.points[i]);
  }
  if (chain.closed) {
    if (!neighbours(chain.points.back(), chain.points.front())) {
      return "a closed chain does not close" + at(chain.points[0]);
    }
    if (chain.first_on_border || chain.last_on_border)
      return "a closed chain has an end" + at(chain.points[0]);
    return {};
  }
  if (chain.first_node >= chains.node_count || chain.last_node >= chains.node_count) {
    return "a node is not counted" + at(chain.points[0]);
  }
  if ((chain.first_on_border && !at_side(chains, chain.points.front())) ||
      (chain.last_on_border && !at_side(chains, chain.points.back()))) {
    return "an end on the border is inside" + at(chain.points[0]);
  }
  return {};
}

/// Everything between chains, looked up by pixel.
class PixelTable {
 public:
  explicit PixelTable(const FeatureChains& chains)
      : chains_(chains), cells_(std::size_t(chains.width) * std::size_t(chains.height), kEmpty) {}

  Defect check() {
    std::vector<const ChainPoint*> node_points(chains_.node_count, nullptr);
    for (const Chain& chain : chains_.chains) {
      for (std::size_t i = 0; i < chain.points.size(); ++i) {
        const bool first = !chain.closed && i == 0;
        const bool last = !chain.closed && i + 1 == chain.points.size();
        const ChainPoint& p = chain.points[i];
        std::size_t& cell = cells_[index(p)];
        if (first || last) {
          const ChainPoint*& known = node_points[first ? chain.first_node : chain.last_node];
          if (known == nullptr && cell != kEmpty) return "two nodes or chains meet" + at(p);
          if (known != nullptr && (known->x != p.x || known->y != p.y || known->position != p.position ||
                                   known->beyond != p.beyond)) {
            return "a node is at two places" + at(p);
          }
          known = &p;
        } else if (cell != kEmpty) {
          return "a pixel is used twice" + at(p);
        }
        if (cell == kEmpty) {
          cell = entries_.size();
          entries_.emplace_back();
        }
        enter(chain, i, entries_[cell]);
      }
    }
    for (const Chain& chain : chains_.chains) {
      for (const ChainPoint& p : chain.points) {
        if (Defect defect = check_around(p)) return defect;
      }
    }
    return {};
  }

 private:
  static constexpr std::size_t kEmpty = std::size_t(-1);

  struct Entry {
    std::vector<ChainPoint> linked;  // the points before and after it
    std::vector<NodeIndex> nodes;    // at most two steps away
  };

  std::size_t index(const ChainPoint& p) const {
    return std::size_t(p.y) * std::size_t(chains_.width) + std::size_t(p.x);
  }

  static void enter(const Chain& chain, std::size_t i, Entry& entry) {
    const std::size_t n = chain.points.size();
    if (chain.closed || i > 0) entry.linked.push_back(chain.points[(i + n - 1) % n]);
    if (chain.closed || i + 1 < n) entry.linked.push_back(chain.points[(i + 1) % n]);
    if (chain.closed) return;
    if (i <= 2) entry.nodes.push_back(chain.first_node);
    if (n - 1 - i <= 2) entry.nodes.push_back(chain.last_node);
  }

  const Entry* find(int x, int y) const {
    if (x < 0 || y < 0 || x >= chains_.width || y >= chains_.height) return nullptr;
    const std::size_t cell = cells_[std::size_t(y) * std::size_t(chains_.width) + std::size_t(x)];
    return cell == kEmpty ? nullptr : &entries_[cell];
  }

  static bool linked(const Entry& entry, int x, int y) {
    return std::any_of(entry.linked.begin(), entry.linked.end(),
                       [&](const ChainPoint& q) { return q.x == x && q.y == y; });
  }

  static bool share_node(const Entry& a, const Entry& b) {
    return std::find_first_of(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end()) !=
           a.nodes.end();
  }

  Defect check_around(const ChainPoint& p) const {
    const Entry& entry = *find(p.x, p.y);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Entry* other = find(p.x + dx, p.y + dy);
        if (other == nullptr || (dx == 0 && dy == 0)) continue;
        if (!linked(entry, p.x + dx, p.y + dy)) {
          if (!share_node(entry, *other)) return "curves touch" + at(p);
        } else if (dx != 0 && dy != 0) {
          const Entry* side = find(p.x + dx, p.y);
          if (side != nullptr && linked(*side, p.x, p.y + dy)) return "diagonal steps cross" + at(p);
        }
      }
    }
    return {};
  }

  const FeatureChains& chains_;
  std::vector<std::size_t> cells_;
  std::vector<Entry> entries_;
};

}  // namespace

std::optional<std::string> find_defect(const FeatureChains& chains) {
  for (const Chain& chain : chains.chains) {
    if (Defect defect = check_chain(chains, chain)) return defect;
  }
  if (Defect defect = PixelTable(chains).check()) return defect;
  const std::vector<StepIndex> crossing = crossing_steps(chains);
  if (!crossing.empty()) {
    return "curves cross" + at(chains.chains[crossing[0].chain].points[crossing[0].point]);
  }
  return {};
}

}  // namespace knotreel::features
