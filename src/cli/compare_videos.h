// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace knotreel::cli {

struct CompareVideos {
  std::string reference;
  std::string result;
  std::string deinterlace = "auto";  ///< of both
  std::string filter;                ///< of the reference
  std::string stats;                 ///< file for the figures of every frame; empty: none
  bool json = false;
  int threads = 0;
};

/// Compares frame by frame and prints what `compare` promises for videos. If one has more frames, there is a
/// warning, and these are left out.
void compare_videos(const CompareVideos& arguments);

}  // namespace knotreel::cli
