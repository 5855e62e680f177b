// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/extract.h"

#include <vector>

#include "features/profile.h"
#include "features/prune.h"
#include "features/untangle.h"

namespace knotreel::features {
namespace {

/// Takes chains out of a copy of the drawing, one after the other.
class Extraction {
 public:
  Extraction(const LinkMap& map, const GradientField& field) : map_(map), rest_(map), field_(field) {}

  FeatureChains run() {
    result_.width = field_.whole_width;
    result_.height = field_.whole_height;
    node_of_.assign(std::size_t(map_.size()), 0);
    for (int i = 0; i < map_.size(); ++i) {
      if (map_.node(i)) node_of_[std::size_t(i)] = result_.node_count++;
    }
    for (int i = 0; i < map_.size(); ++i) {
      if (map_.node(i)) take_all_from(i);
    }
    for (int i = 0; i < map_.size(); ++i) {
      if (rest_.drawn(i)) take_all_from(i);
    }
    return std::move(result_);
  }

 private:
  void take_all_from(int i) {
    for (int d = 0; d < 8; ++d) {
      if (!rest_.linked(i, d)) continue;
      const Stretch stretch = stretch_from(map_, i, d);
      rest_.unlink_all(stretch.pixels);
      if (stretch.closed) rest_.unlink(stretch.pixels.back(), stretch.pixels.front());
      add(stretch);
    }
  }

  void add(const Stretch& stretch) {
    Chain& chain = result_.chains.emplace_back();
    chain.closed = stretch.closed;
    for (const int i : stretch.pixels) {
      const int x = map_.x(i);
      const int y = map_.y(i);
      chain.points.push_back({field_.origin_x + x, field_.origin_y + y, refine_position(field_, x, y)});
    }
    if (chain.closed) return;
    const int first = stretch.pixels.front();
    const int last = stretch.pixels.back();
    chain.first_node = node_of_[std::size_t(first)];
    chain.last_node = node_of_[std::size_t(last)];
    chain.first_on_border = map_.at_side(first);
    chain.last_on_border = map_.at_side(last);
  }

  const LinkMap& map_;
  LinkMap rest_;
  const GradientField& field_;
  FeatureChains result_;
  std::vector<NodeIndex> node_of_;
};

}  // namespace

FeatureChains extract_chains(const LinkMap& map, const GradientField& field) {
  FeatureChains chains = Extraction(map, field).run();
  untangle(chains, pixel_centres_of(chains));
  return chains;
}

}  // namespace knotreel::features
