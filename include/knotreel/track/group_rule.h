// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/track/tracker.h"

namespace knotreel::track {

/// Says where groups start, as far as that can be told without any model: at the first frame, at cuts, and
/// when a group is full. What drifts is only known when it has been made.
class GroupRule {
 public:
  /// @param first what to say of the first frame.
  /// @throws Error{kInvalidArgument} for options out of range.
  explicit GroupRule(const TrackOptions& options, Start first = Start::kFirst);

  /// @param motion  as for Tracker::next(), frame by frame. @return never kDrift.
  Start next(const Motion* motion);

  /// What next() will say.
  Start start_of(const Motion* motion) const;

  /// The frame that was asked for last starts a group after all.
  void restart() { length_ = 1; }

 private:
  TrackOptions options_;
  Start first_;
  int length_ = 0;  ///< frames of the group so far; 0: there is none yet
};

}  // namespace knotreel::track
