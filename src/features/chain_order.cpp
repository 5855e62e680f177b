// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/chain_order.h"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "features/link_map.h"

namespace knotreel::features {
namespace {

/// Rows and columns in one number.
std::uint64_t place_of(const ChainPoint& p) {
  return std::uint64_t(p.y) << 32U | std::uint64_t(p.x);
}

/// As LinkMap counts them.
int first_step(const Chain& chain) {
  const ChainPoint& from = chain.points[0];
  const ChainPoint& to = chain.points[1];
  int d = 0;
  while (d < 8 && (kStepX[d] != to.x - from.x || kStepY[d] != to.y - from.y)) ++d;
  return d;
}

}  // namespace

void sort_as_found(FeatureChains& chains) {
  const auto key = [](const Chain& chain) {
    return std::tuple(chain.closed, place_of(chain.points.front()), first_step(chain));
  };
  std::sort(chains.chains.begin(), chains.chains.end(),
            [&](const Chain& a, const Chain& b) { return key(a) < key(b); });
}

void number_nodes(std::initializer_list<FeatureChains*> lists) {
  std::vector<std::uint64_t> nodes;
  for (const FeatureChains* list : lists) {
    for (const Chain& chain : list->chains) {
      if (chain.closed) continue;
      nodes.push_back(place_of(chain.points.front()));
      nodes.push_back(place_of(chain.points.back()));
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const auto number = [&](const ChainPoint& p) {
    return NodeIndex(std::lower_bound(nodes.begin(), nodes.end(), place_of(p)) - nodes.begin());
  };
  for (FeatureChains* list : lists) {
    list->node_count = NodeIndex(nodes.size());
    for (Chain& chain : list->chains) {
      if (chain.closed) continue;
      chain.first_node = number(chain.points.front());
      chain.last_node = number(chain.points.back());
    }
  }
}

}  // namespace knotreel::features
