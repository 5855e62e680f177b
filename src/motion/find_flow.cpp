#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "knotreel/base/parallel.h"
#include "knotreel/motion/flow.h"
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

}  // namespace

Flow find_flow(const Luma& from, const Luma& to, const FlowOptions& options) {
  check_sizes(from, to);
  cv::Mat found;
  make_search(options.effort)->calc(large_enough(from), large_enough(to), found);
  Flow flow{from.width, from.height, std::vector<float>(2 * from.v.size())};
  const std::size_t row = 2 * std::size_t(from.width);
  for (int y = 0; y < from.height; ++y) {
    std::copy_n(found.ptr<float>(y), row, flow.xy.data() + std::size_t(y) * row);
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

}  // namespace knotreel::motion
