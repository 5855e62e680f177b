#include <algorithm>
#include <numeric>

#include "export/layers.h"

namespace knotreel::exporting {

namespace {

/// Regions of faces that may share a layer, and the pairs of faces that must not.
class Regions {
 public:
  explicit Regions(const Sheets& sheets) : sheets_(sheets), parent_(sheets.faces().size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    members_.resize(parent_.size());
    rivals_.resize(parent_.size());
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

  /// The faces on both sides of each feature edge, and all pairs from the two fans that meet at its origin.
  void collect_rivals() {
    for (std::uint32_t h = 0; h < sheets_.half_edge_count(); ++h) {
      if (!sheets_.is_feature(h)) continue;
      const std::uint32_t o = sheets_.opposite(h);
      rivals_[h / 3].push_back(o / 3);
      const CornerIndex here = sheets_.origin(h);
      const CornerIndex there = sheets_.target(o);
      if (here == there) continue;  // an open tip: its one fan lies on both sides
      for (const std::uint32_t a : sheets_.around(here)) {
        for (const std::uint32_t b : sheets_.around(there)) {
          rivals_[a / 3].push_back(b / 3);
          rivals_[b / 3].push_back(a / 3);
        }
      }
    }
    for (auto& r : rivals_) {
      std::sort(r.begin(), r.end());
      r.erase(std::unique(r.begin(), r.end()), r.end());
    }
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
    for (const std::uint32_t member : members_[g]) {
      for (const std::uint32_t rival : rivals_[member]) {
        if (find(rival) == f) return;
      }
    }
    parent_[g] = f;
    members_[f].insert(members_[f].end(), members_[g].begin(), members_[g].end());
    members_[g] = {};
  }

  const Sheets& sheets_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::vector<std::uint32_t>> rivals_;
};

/// Greedy colouring, largest region first. Faces without rivals stay in layer 0.
std::vector<std::uint32_t> Regions::layers() const {
  std::vector<std::uint32_t> order;
  for (std::uint32_t f = 0; f < parent_.size(); ++f) {
    if (parent_[f] == f && (members_[f].size() > 1 || !rivals_[f].empty())) order.push_back(f);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return members_[a].size() > members_[b].size(); });
  constexpr std::uint32_t kUnset = 0xffffffffu;
  std::vector<std::uint32_t> layer(parent_.size(), kUnset);
  for (const std::uint32_t region : order) {
    std::vector<std::uint32_t> taken;
    for (const std::uint32_t member : members_[region]) {
      for (const std::uint32_t rival : rivals_[member]) {
        if (layer[rival] != kUnset) taken.push_back(layer[rival]);
      }
    }
    std::sort(taken.begin(), taken.end());
    std::uint32_t free = 0;
    for (const std::uint32_t t : taken) free += t == free ? 1 : 0;
    for (const std::uint32_t member : members_[region]) layer[member] = free;
  }
  std::replace(layer.begin(), layer.end(), kUnset, 0u);
  return layer;
}

}  // namespace

std::vector<std::uint32_t> assign_layers(const Sheets& sheets) {
  return Regions(sheets).layers();
}

}  // namespace knotreel::exporting
