// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "knotreel/base/parallel.h"
#include "knotreel/motion/flow.h"
#include "motion/changed_boxes.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

/// Smaller pictures have no room for a pyramid of patches.
constexpr int kLeastSide = 32;

int preset(FlowOptions::Effort effort) {
  switch (effort) {
    case FlowOptions::Effort::kUltrafast:
      return cv::DISOpticalFlow::PRESET_ULTRAFAST;
    case FlowOptions::Effort::kFast:
      return cv::DISOpticalFlow::PRESET_FAST;
    case FlowOptions::Effort::kMedium:
      break;
  }
  return cv::DISOpticalFlow::PRESET_MEDIUM;
}

cv::Ptr<cv::DISOpticalFlow> make_search(FlowOptions::Effort effort) {
  const cv::Ptr<cv::DISOpticalFlow> search = cv::DISOpticalFlow::create(preset(effort));
  // Spatial propagation is what keeps stripes of patches, and with them the bits, the same for any number of
  // threads; it is the default of all presets.
  search->setUseSpatialPropagation(true);
  return search;
}

/// The picture itself if it is large enough, else a copy that is continued to the right and below.
cv::Mat large_enough(const Luma& luma) {
  // OpenCV has no matrices of constants; this one is only read.
  cv::Mat picture(luma.height, luma.width, CV_8UC1, const_cast<std::uint8_t*>(luma.v.data()));
  const int below = std::max(0, kLeastSide - luma.height);
  const int right = std::max(0, kLeastSide - luma.width);
  if (below == 0 && right == 0) return picture;
  cv::Mat larger;
  cv::copyMakeBorder(picture, larger, 0, below, 0, right, cv::BORDER_REPLICATE);
  return larger;
}

constexpr int kLeastMargin = 48;       // pixels
constexpr double kMostSearched = 0.7;  // share of the pixels, from which on parts save nothing

/// Around what has changed, pixels: motion is looked for there, and taken from the inner half. Where
/// something was and where it has gone, up to an eighth of the smaller side, is in one box.
int margin_for(const Luma& luma) {
  return std::max(kLeastMargin, std::min(luma.width, luma.height) / 16);
}

Luma part_of(const Luma& luma, const PixelBox& box) {
  Luma part{box.width(), box.height(), {}};
  part.v.reserve(std::size_t(part.width) * std::size_t(part.height));
  for (int y = box.top; y < box.bottom; ++y) {
    const auto row = luma.v.begin() + std::ptrdiff_t{y} * luma.width;
    part.v.insert(part.v.end(), row + box.left, row + box.right);
  }
  return part;
}

FlowPair no_motion(int width, int height) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  FlowPair still;
  for (Flow* flow : {&still.forward, &still.backward})
    *flow = {width, height, std::vector<float>(2 * pixels)};
  still.consistent.assign(pixels, 1);
  still.consistent_back.assign(pixels, 1);
  return still;
}

/// Copies what was found in a box, but for its margin where it does not end at the picture's.
void paste(const FlowPair& part, const PixelBox& box, int margin, FlowPair& all) {
  const int width = all.forward.width;
  const int height = all.forward.height;
  const int cut = margin / 2;
  const int left = box.left == 0 ? 0 : box.left + cut;
  const int right = box.right == width ? width : box.right - cut;
  const int top = box.top == 0 ? 0 : box.top + cut;
  const int bottom = box.bottom == height ? height : box.bottom - cut;
  const auto count = std::size_t(right - left);
  for (int y = top; y < bottom; ++y) {
    const std::size_t from =
        std::size_t(y - box.top) * std::size_t(box.width()) + std::size_t(left - box.left);
    const std::size_t to = std::size_t(y) * std::size_t(width) + std::size_t(left);
    const auto copy = [&](const auto& source, auto& target, std::size_t size) {
      std::copy_n(source.begin() + std::ptrdiff_t(size * from), size * count,
                  target.begin() + std::ptrdiff_t(size * to));
    };
    copy(part.forward.xy, all.forward.xy, 2);
    copy(part.backward.xy, all.backward.xy, 2);
    copy(part.consistent, all.consistent, 1);
    copy(part.consistent_back, all.consistent_back, 1);
  }
}

}  // namespace

Flow find_flow(const Luma& from, const Luma& to, const FlowOptions& options) {
  check_sizes(from, to);
  cv::Mat found;
  make_search(options.effort)->calc(large_enough(from), large_enough(to), found);
  Flow flow{from.width, from.height, {}};
  flow.xy.reserve(2 * from.v.size());
  for (int y = 0; y < from.height; ++y) {
    const float* row = found.ptr<float>(y);
    flow.xy.insert(flow.xy.end(), row, row + 2 * from.width);
  }
  return flow;
}

Flow find_flow(const image::Image& from, const image::Image& to, const FlowOptions& options) {
  check_sizes(from, to);
  return find_flow(luma_of(from), luma_of(to), options);
}

FlowPair find_flow_pair(const Luma& from, const Luma& to, const FlowOptions& options) {
  check_sizes(from, to);
  const FlowOptions back = options.turn_back ? FlowOptions{FlowOptions::Effort::kUltrafast} : options;
  FlowPair pair;
  parallel_for(2, [&](std::size_t direction) {
    if (direction == 0) {
      pair.forward = find_flow(from, to, options);
    } else {
      pair.backward = find_flow(to, from, back);
    }
  });
  pair.consistent_back =
      options.turn_back ? turn_round(pair.forward, pair.backward) : consistent(pair.backward, pair.forward);
  pair.consistent = consistent(pair.forward, pair.backward);
  return pair;
}

FlowPair find_flow_pair(const Luma& from, const Luma& to, std::span<const std::uint8_t> unchanged,
                        const FlowOptions& options) {
  check_sizes(from, to);
  const int margin = margin_for(from);
  const std::vector<PixelBox> boxes = changed_boxes(unchanged, from.width, from.height, margin);
  double searched = 0;
  for (const PixelBox& box : boxes) searched += static_cast<double>(box.width()) * box.height();
  if (searched > kMostSearched * double(from.v.size())) return find_flow_pair(from, to, options);
  FlowPair result = no_motion(from.width, from.height);
  for (const PixelBox& box : boxes)
    paste(find_flow_pair(part_of(from, box), part_of(to, box), options), box, margin, result);
  return result;
}

}  // namespace knotreel::motion
