// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

#include "knotreel/vectorize/vectorize.h"

namespace knotreel::vectorize {

/// What a run tells of itself: figures and times of its rounds, and what there is to see after its stages.
class RunLog {
 public:
  /// @param picture, observer outlive this.
  RunLog(const image::Image& picture, const Observer& observer) : observer_(observer) {
    progress.picture = &picture;
  }

  void begin_round(std::string name);
  RoundReport& round() { return report.rounds.back(); }
  /// Ends a stage of the round, which began when the last one ended.
  void lap(const char* stage);
  /// Shows the progress to the observer, whose time belongs to no stage.
  void show(const std::string& stage);
  /// Tells the observer of a step, of which there is nothing to see.
  void step(const std::string& stage) const;

  Report report;
  Progress progress;

 private:
  using Clock = std::chrono::steady_clock;

  const Observer& observer_;
  Clock::time_point start_ = Clock::now();  ///< of the stage
};

}  // namespace knotreel::vectorize
