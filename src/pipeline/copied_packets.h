// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/pipeline/render_job.h"
#include "pipeline/schedule.h"

namespace knotreel::pipeline {

/// The packets of the copied streams that go along with frames that a document gives: of the time in which
/// these are shown, and moved as they are. One thread at a time.
class CopiedPackets {
 public:
  CopiedPackets(const RenderJob& job, const Schedule& schedule);

  /// What is to be written by the end of a frame; frames in order.
  std::vector<video::Packet> until_end_of(const Showing& frame);
  /// What is to be written after the last one.
  std::vector<video::Packet> rest();

 private:
  double source_seconds(std::int64_t pts) const;
  std::vector<video::Packet> moved(std::vector<video::Packet> packets) const;

  video::VideoReader* reader_;
  std::int64_t origin_;  ///< as in Schedule
  video::Rational document_tick_;
  video::Rational tick_;  ///< of the frames
  double begin_;          ///< of what is copied, seconds of the source
  double end_;            ///< see begin_
};

}  // namespace knotreel::pipeline
