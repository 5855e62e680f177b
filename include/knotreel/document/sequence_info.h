// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace knotreel::document {

/// What all frames of a document have in common.
struct SequenceInfo {
  int width = 0;     ///< of the source image and of the parametric domain, in pixels, 1 to 1,000,000
  int height = 0;    ///< likewise
  int channels = 3;  ///< colour channels, 1 to 4: grey, grey + alpha, RGB, RGBA
  int degree = 2;    ///< of the splines, 1 to 3

  /// One unit of FrameModel::pts is time_base_num / time_base_den seconds; both 1 to 2^31 - 1.
  std::int64_t time_base_num = 1;
  std::int64_t time_base_den = 25;

  /// Free text by name, UTF-8, for people and for other programs: "title", "source", "encoder", ...
  std::map<std::string, std::string> metadata;

  friend bool operator==(const SequenceInfo&, const SequenceInfo&) = default;
};

}  // namespace knotreel::document
