// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/draw.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "features/join.h"
#include "features/profile.h"
#include "features/prune.h"
#include "features/walk.h"
#include "knotreel/base/parallel.h"

namespace knotreel::features {
namespace {

/// Extrema of the magnitude across the edge, strongest first. Of two equal neighbours the left or upper one
/// is taken: a step between pixels has equal magnitudes on both sides.
std::vector<std::pair<int, int>> find_anchors(const GradientField& field, double threshold) {
  const auto rows = std::size_t(std::max(0, field.height - 2));
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> found(rows);
  const auto least = float(threshold);
  parallel_for(rows, [&](std::size_t row) {
    const std::size_t begin = field.at(0, int(row) + 1);
    for (std::size_t i = begin + 1; i + 1 < begin + std::size_t(field.width); ++i) {
      const float m = field.magnitude[i];
      if (m < least) continue;
      const std::size_t across = is_vertical(field.inner_gradient(i)) ? 1 : std::size_t(field.width);
      if (m <= field.magnitude[i - across] || m < field.magnitude[i + across]) continue;
      // Positive floats are ordered like their bits; turned over for the strongest first.
      found[row].push_back({~std::bit_cast<std::uint32_t>(m), std::uint32_t(i)});
    }
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> anchors;
  for (const auto& row : found) anchors.insert(anchors.end(), row.begin(), row.end());
  std::sort(anchors.begin(), anchors.end());
  std::vector<std::pair<int, int>> pixels;
  pixels.reserve(anchors.size());
  for (const auto& [strength, i] : anchors) {
    pixels.emplace_back(int(i % std::uint32_t(field.width)), int(i / std::uint32_t(field.width)));
  }
  return pixels;
}

/// Draws the walks that are hard and long enough.
class Drawing {
 public:
  Drawing(const GradientField& field, const DetectOptions& options, const Worth& worth)
      : field_(field),
        options_(options),
        worth_(worth),
        map_(field.width, field.height),
        walker_(field, map_, options.edge_threshold),
        given_up_(std::size_t(map_.size()), 0) {}

  LinkMap run() {
    for (const auto& [x, y] : find_anchors(field_, options_.anchor_threshold)) {
      const int anchor = map_.index(x, y);
      if (given_up_[std::size_t(anchor)]) continue;
      for (const std::vector<int>& part : hard_parts(walker_.walk(anchor))) place(part);
    }
    drop_spurs(map_, worth_);
    // By now there are chains where there was nothing to join when a walk ended, and stubs are gone. Gaps are
    // closed last: a contour that closes on itself must not reach out for others before.
    for (const auto& [tip, inner] : tips_) {
      if (join_tip(map_, tip, Join::kGaps)) drop_if_worthless(map_, inner, worth_);
    }
    prune(map_, worth_);
    return std::move(map_);
  }

 private:
  std::vector<std::vector<int>> hard_parts(const std::vector<int>& path);
  void place(const std::vector<int>& path);
  /// Anchors beside the path are of the same ridge: they would start the same walk once more.
  void give_up(int pixel) {
    given_up_[std::size_t(pixel)] = 1;
    for (int d = 0; d < 8; ++d) given_up_[std::size_t(map_.neighbour(pixel, d))] = 1;
  }
  void give_up(const std::vector<int>& path) {
    for (const int i : path) give_up(i);
  }

  const GradientField& field_;
  const DetectOptions& options_;
  const Worth& worth_;
  LinkMap map_;
  Walker walker_;
  std::vector<std::uint8_t> given_up_;  // of each pixel: no walk starts there
  /// Ends of what was placed, in that order, each with a pixel from the middle of the path.
  std::vector<std::pair<int, int>> tips_;
};

/// The parts of a path that are no softer than max_blur, by the mean over a few pixels: single ones are
/// noisy. Soft parts are closed, or every anchor beside them would start the same walk again.
std::vector<std::vector<int>> Drawing::hard_parts(const std::vector<int>& path) {
  if (path.empty()) return {};
  if (options_.max_blur <= 0) return {path};
  constexpr std::size_t kHalfWindow = 4;
  std::vector<Transition> sums(path.size() + 1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Transition t = transition(field_, map_.x(path[i]), map_.y(path[i]));
    sums[i + 1] = {sums[i].contrast + t.contrast, sums[i].slope + t.slope};
  }
  std::vector<std::vector<int>> parts;
  bool open = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t begin = i < kHalfWindow ? 0 : i - kHalfWindow;
    const std::size_t end = std::min(path.size(), i + kHalfWindow + 1);
    const bool hard = sums[end].contrast - sums[begin].contrast <=
                      options_.max_blur * (sums[end].slope - sums[begin].slope);
    if (hard) {
      if (!open) parts.emplace_back();
      parts.back().push_back(path[i]);
    } else {
      walker_.close(path[i]);
      give_up(path[i]);
    }
    open = hard;
  }
  return parts;
}

void Drawing::place(const std::vector<int>& path) {
  // A single pixel has no link; and what is joined at both ends still needs room between the junctions.
  if (path.size() < std::size_t(kNodeDistance)) return give_up(path);
  map_.link_all(path);
  const int ends[2] = {path.front(), path.back()};
  bool joined[2];
  for (int e = 0; e < 2; ++e) joined[e] = join_tip(map_, ends[e], Join::kContacts);
  for (int e = 0; e < 2; ++e) {
    if (!joined[e]) extend_to_side(map_, ends[e]);
  }
  // Weak chains are drawn late; what is dropped at once does not stand in their way.
  if (drop_if_worthless(map_, path[path.size() / 2], worth_)) return give_up(path);
  for (int e = 0; e < 2; ++e) {
    if (!joined[e]) tips_.emplace_back(ends[e], path[path.size() / 2]);
  }
}

}  // namespace

LinkMap draw_edges(const GradientField& field, const DetectOptions& options) {
  const Worth worth{field, options.min_length, options.min_weight};
  return Drawing(field, options, worth).run();
}

}  // namespace knotreel::features
