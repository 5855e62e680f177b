// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "libav.h"

namespace knotreel::video {

/// The times of a file whose clock may start anew in its middle, as that of transport and program streams
/// that were put one behind another: what is behind such a joint follows what is before it, all streams moved
/// by the same time. A clock that leaps ahead is left alone: that is a gap.
class JoinedTimes {
 public:
  /// Moves the times of the next packet of the file.
  /// @param stream that it is of.
  void move(AVPacket& packet, const AVStream& stream);

  /// How often the clock has started anew.
  std::size_t joints() const { return parts_.size() - 1; }

  /// How many joints lie before the last packet of a stream.
  std::size_t joints_before(int stream) const {
    const auto found = clocks_.find(stream);
    return found == clocks_.end() ? 0 : found->second.part;
  }

 private:
  /// What is between two joints. Times and steps are microseconds.
  struct Part {
    std::int64_t step = 0;    ///< that its times are moved by
    std::int64_t begin = -1;  ///< place in the file of the first packet of it, bytes; -1: not known
  };
  struct Clock {
    std::size_t part = 0;
    std::int64_t now = 0;       ///< of the last packet, moved
    std::int64_t duration = 0;  ///< likewise
  };

  std::size_t part_of(const AVPacket& packet, const AVStream& stream, const Clock& clock, std::int64_t time);

  std::vector<Part> parts_{1};
  std::map<int, Clock> clocks_;                                  ///< by stream
  std::int64_t end_ = std::numeric_limits<std::int64_t>::min();  ///< the latest time so far, moved
};

}  // namespace knotreel::video
