// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "knotreel/pipeline/render_job.h"

namespace knotreel::pipeline {

/// Which frame of a document is shown when.
struct Showing {
  std::size_t frame = 0;  ///< place in the document
  double share = 0;       ///< of the way to the next frame, below 1; see track::between()
  std::int64_t pts = 0;
  std::int64_t duration = 0;
};

/// The frames to be shown, one after the other: at another rate there may be more of them than memory has
/// room for.
class Schedule {
 public:
  /// @throws Error{kInvalidArgument} if the job's range is not in the document, or there are more than 2^53
  /// frames.
  explicit Schedule(const RenderJob& job);

  /// Of what is to be written.
  const video::StreamInfo& stream() const { return stream_; }
  /// Time of the source that the times of the frames count from, in ticks of the document.
  std::int64_t origin() const { return origin_; }
  std::int64_t begin() const;  ///< of the first frame
  std::int64_t end() const;    ///< of the last one

  std::uint64_t count() const { return static_cast<std::uint64_t>(count_); }  ///< of all frames

  /// The next frame; none after the last one.
  std::optional<Showing> next();

 private:
  Showing resampled(std::int64_t tick);

  const document::Reader* reader_;
  std::vector<Showing> stored_;
  video::StreamInfo stream_;
  std::int64_t origin_ = 0;
  double ticks_per_frame_ = 0;  ///< of the document, for another rate; 0: frames as they are stored
  std::int64_t count_ = 0;
  std::int64_t next_ = 0;
  std::size_t at_ = 0;  ///< the stored frame that is shown at the time reached
};

}  // namespace knotreel::pipeline
