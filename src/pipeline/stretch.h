#pragma once

#include <cstdint>
#include <map>
#include <mutex>

#include "knotreel/track/tracker.h"
#include "pipeline/message.h"

namespace knotreel::pipeline {

/// Frames from one cut to the next: nothing before has any influence on their models, so stretches may be
/// worked on at the same time. Their messages own them.
struct Stretch {
  Stretch(std::uint64_t begin, const Job& job, track::Start start)
      : tracker(job.cold, job.tracking, start), next(begin) {}

  track::Tracker tracker;  ///< frame by frame, in order

  // For InOrderWithinStretches.
  std::mutex mutex;
  std::uint64_t next;                           ///< whose turn it is
  bool busy = false;                            ///< somebody is at work, and will see to those that wait
  std::map<std::uint64_t, MessagePtr> waiting;  ///< by index
};

}  // namespace knotreel::pipeline
