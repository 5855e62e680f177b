// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace knotreel::image {

/// The two functions of OpenCV's imgcodecs that are used.
struct Imgcodecs {
  cv::Mat (*decode)(cv::InputArray, int) = nullptr;
  bool (*encode)(const cv::String&, cv::InputArray, std::vector<unsigned char>&,
                 const std::vector<int>&) = nullptr;
};

/// Loads the library with the first picture that needs it (docs/decisions/0028-codecs-on-demand.md).
/// Thread-safe.
/// @param why  what is wrong if it cannot be loaded
/// @return null then
const Imgcodecs* imgcodecs(std::string& why);

}  // namespace knotreel::image
