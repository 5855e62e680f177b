// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "knotreel/pipeline/job.h"
#include "pipeline/message.h"

namespace knotreel::pipeline {

/// The video of what Job::compose makes of each frame.
class BesideOutput {
 public:
  explicit BesideOutput(const Job& job) : job_(job) {}

  /// Makes the picture; several messages at once.
  void compose(Message& message) const;
  /// Writes it, or the last one again if the message repeats that; in order, one at a time. The first one
  /// says how large the video is. @throws as VideoWriter.
  void write(Message& message);
  void finish();

 private:
  const Job& job_;
  std::optional<video::VideoWriter> writer_;
  image::Image written_;  ///< last
};

}  // namespace knotreel::pipeline
