// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "knotreel/track/tracker.h"
#include "pipeline/message.h"

namespace knotreel::pipeline {

/// Whose turn it is among frames that follow each other, for InOrderWithinStretches.
struct Turns {
  explicit Turns(std::uint64_t begin) : next(begin) {}

  std::mutex mutex;
  std::uint64_t next;
  bool busy = false;                            ///< somebody is at work, and will see to those that wait
  std::map<std::uint64_t, MessagePtr> waiting;  ///< by index
};

/// Frames from one cut to the next: nothing before has any influence on their models, so stretches may be
/// worked on at the same time. Their messages own them.
struct Stretch {
  /// @param among those of the stretch before, if this one is to wait for it; null: it need not.
  Stretch(std::uint64_t begin, const Job& job, track::Start start, std::shared_ptr<Turns> among = nullptr)
      : tracker(job.cold, job.tracking, start),
        turns(among ? std::move(among) : std::make_shared<Turns>(begin)) {}

  track::Tracker tracker;  ///< frame by frame, in order
  std::shared_ptr<Turns> turns;
};

}  // namespace knotreel::pipeline
