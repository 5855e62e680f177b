// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <optional>

#include "filter_graph.h"
#include "knotreel/video/reader.h"
#include "warnings.h"

namespace knotreel::video {

/// Decoded frames on their way to whoever reads them: interlaced ones are made whole, and filters that were
/// asked for are applied. Others pass untouched, and libavfilter is not loaded for them. One thread at a
/// time.
class FrameFilter {
 public:
  /// @param stream that the frames are of. @param warnings  told what was done.
  FrameFilter(const ReadOptions& options, const StreamInfo& stream, Warnings& warnings);

  /// The next frame; null: there are no more. To be called when receive() has said null.
  /// @throws Error{kInvalidArgument} if libavfilter does not take the filters.
  void send(FramePtr frame);

  /// The next frame, its time in ticks of time_base(); null if one has to be sent first, or at the end.
  FramePtr receive();

  /// Forgets the frames that it has: those sent next do not follow them.
  void reset();

  /// Whether frames may come at other times than they were sent with, or more or fewer of them.
  bool changes_times() const { return mode_ == Deinterlace::kFields || !filter_.empty(); }
  /// Of frames handed out; of use once there has been one.
  AVRational time_base() const { return time_base_; }
  AVRational frame_rate() const { return rate_; }

 private:
  std::string filters_for(const AVFrame& frame) const;
  void complete(AVFrame& frame) const;
  void set_up(const AVFrame& frame, const std::string& filters);
  std::int64_t end_of(const AVFrame& frame) const;
  void drain(std::int64_t end);
  FramePtr from_graph();

  Deinterlace mode_;
  std::string filter_;
  AVRational sent_time_base_, time_base_, sent_rate_, rate_, sent_aspect_;
  bool has_clock_ = false;                  ///< time_base_ and rate_ are those of a graph
  bool deinterlaces_ = false;               ///< graph_ does
  bool given_up_ = false;                   ///< on deinterlacing
  std::int64_t sent_end_ = 0;               ///< of the last frame that was sent
  std::int64_t last_pts_ = AV_NOPTS_VALUE;  ///< that a filter gave
  Warnings& warnings_;
  std::optional<FilterGraph> graph_;
  std::deque<FramePtr> ready_;
};

}  // namespace knotreel::video
