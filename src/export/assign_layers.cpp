// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>

#include "export/layers.h"

namespace knotreel::exporting {

namespace {

/// Regions of faces that may share a layer, and the fans whose faces must not. Fans may have very many faces,
/// so what is told of their faces is told of the fans.
class Regions {
 public:
  explicit Regions(const Sheets& sheets) : sheets_(sheets), parent_(sheets.faces().size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    members_.resize(parent_.size());
    for (std::uint32_t f = 0; f < parent_.size(); ++f) members_[f] = {f};
    collect_rivals();
    join_fans();
  }

  std::vector<std::uint32_t> layers() const;

 private:
  std::uint32_t find(std::uint32_t f) const {
    while (parent_[f] != f) f = parent_[f];
    return f;
  }

  /// The two fans that meet at an end of a feature edge. Those of one of its ends at least are two, so the
  /// faces on both sides of the edge are among them.
  void collect_rivals() {
    for (std::uint32_t h = 0; h < sheets_.half_edge_count(); ++h) {
      if (!sheets_.is_feature(h)) continue;
      const CornerIndex here = sheets_.origin(h);
      const CornerIndex there = sheets_.target(sheets_.opposite(h));
      if (here == there) continue;  // an open tip: its one fan lies on both sides
      add_rival(here, there);
      add_rival(there, here);
    }
    fans_.resize(parent_.size());
    for (std::uint32_t f = 0; f < parent_.size(); ++f) {
      for (const CornerIndex c : sheets_.faces()[f]) {
        if (rivals_.contains(c)) fans_[f].insert(c);
      }
    }
  }

  /// A fan has one rival or two.
  void add_rival(CornerIndex fan, CornerIndex rival) {
    std::vector<CornerIndex>& all = rivals_[fan];
    if (std::find(all.begin(), all.end(), rival) == all.end()) all.push_back(rival);
  }

  /// One region for each fan around a knot of a feature, as far as no rivals come together; around open tips
  /// they would.
  void join_fans() {
    for (std::uint32_t h = 0; h < sheets_.half_edge_count(); ++h) {
      if (!sheets_.is_feature(h)) continue;
      for (const CornerIndex c : {sheets_.origin(h), sheets_.target(h)}) {
        for (const std::uint32_t a : sheets_.around(c)) join(h / 3, a / 3);
      }
    }
  }

  void join(std::uint32_t f, std::uint32_t g) {
    f = find(f);
    g = find(g);
    if (f == g) return;
    if (members_[f].size() < members_[g].size()) std::swap(f, g);
    for (const CornerIndex fan : fans_[g]) {
      for (const CornerIndex rival : rivals_.at(fan)) {
        if (fans_[f].contains(rival)) return;
      }
    }
    parent_[g] = f;
    members_[f].insert(members_[f].end(), members_[g].begin(), members_[g].end());
    members_[g] = {};
    fans_[f].merge(fans_[g]);
    fans_[g] = {};
  }

  const Sheets& sheets_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::vector<std::uint32_t>> members_;
  std::unordered_map<CornerIndex, std::vector<CornerIndex>> rivals_;  ///< of fans that have any
  std::vector<std::set<CornerIndex>> fans_;  ///< by region: those of its faces that have rivals
};

/// Greedy colouring, largest region first. Faces without rivals stay in layer 0.
std::vector<std::uint32_t> Regions::layers() const {
  std::vector<std::uint32_t> order;
  for (std::uint32_t f = 0; f < parent_.size(); ++f) {
    if (parent_[f] == f && (members_[f].size() > 1 || !fans_[f].empty())) order.push_back(f);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return members_[a].size() > members_[b].size(); });
  std::vector<std::uint32_t> layer(parent_.size(), 0);
  std::unordered_map<CornerIndex, std::set<std::uint32_t>> layers_of;  // of the faces of a fan
  for (const std::uint32_t region : order) {
    std::set<std::uint32_t> taken;
    for (const CornerIndex fan : fans_[region]) {
      for (const CornerIndex rival : rivals_.at(fan)) {
        const std::set<std::uint32_t>& theirs = layers_of[rival];
        taken.insert(theirs.begin(), theirs.end());
      }
    }
    std::uint32_t free = 0;
    for (const std::uint32_t t : taken) free += t == free ? 1 : 0;
    for (const std::uint32_t member : members_[region]) layer[member] = free;
    for (const CornerIndex fan : fans_[region]) layers_of[fan].insert(free);
  }
  return layer;
}

}  // namespace

std::vector<std::uint32_t> assign_layers(const Sheets& sheets) {
  return Regions(sheets).layers();
}

}  // namespace knotreel::exporting
