// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::image {

/// While one of these lives, nothing that the process writes to standard error is seen. The codecs behind
/// OpenCV report there on their own account, and an error of ours must be one line. Nests, from any thread.
class QuietStandardError {
 public:
  QuietStandardError();
  ~QuietStandardError();
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;
};

}  // namespace knotreel::image
