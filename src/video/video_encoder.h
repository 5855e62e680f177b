// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>

#include "knotreel/image/image.h"
#include "knotreel/video/writer.h"
#include "libav.h"
#include "warnings.h"

namespace knotreel::video {

/// Frames to packets, with times and durations kept.
class VideoEncoder {
 public:
  /// Takes the packets, whose times are in time_base().
  using Receiver = std::function<void(AVPacket&)>;

  /// @throws Error{kInvalidArgument} for what cannot be encoded so.
  VideoEncoder(const StreamInfo& frames, const WriteOptions& options, const AVOutputFormat& container);

  void write(const image::Image& image, std::int64_t pts, std::int64_t duration, Warnings& warnings,
             const Receiver& receiver);
  /// Gives out what the encoder still holds.
  void finish(const Receiver& receiver);

  const AVCodecContext& context() const { return *encoder_; }
  AVRational time_base() const { return encoder_->time_base; }
  /// Whether WriteOptions::crf has been of use, if it was given.
  bool takes_crf() const { return takes_crf_; }
  /// How long the last frame lasts, in time_base().
  std::int64_t last_duration() const { return last_end_ - last_pts_; }
  /// What the encoder has to say of WriteOptions::encoder_options; empty if nothing.
  const std::string& complaint() const { return complaint_; }

 private:
  void set_colours();
  void set_times(const AVOutputFormat& container);
  void open(const WriteOptions& options, const AVOutputFormat& container);
  std::int64_t ticks_of(std::int64_t time) const;
  std::int64_t most_repeats() const;
  std::int64_t milliseconds() const;
  bool is_moved(std::int64_t pts, std::int64_t time) const;
  void cut_gap_before(AVFrame& frame, Warnings& warnings);
  void repeat_until(std::int64_t pts, const Receiver& receiver);
  void send(AVFrame* frame, const Receiver& receiver);

  StreamInfo info_;
  CodecPtr encoder_;
  std::map<std::int64_t, std::int64_t> durations_;  // of frames in the encoder, by their time
  std::int64_t first_time_ = 0, first_pts_ = 0;     // of the source, of the output
  std::int64_t last_pts_ = AV_NOPTS_VALUE;
  std::int64_t last_end_ = 0;
  bool fills_gaps_ = false;   // with repeated frames, where times are not kept and rates are not free
  FramePtr last_;             // as it was sent
  std::int64_t cut_out_ = 0;  // ticks of gaps that are too long
  bool takes_crf_ = true;
  bool is_webp_ = false;
  bool clears_ = false;  // GIFs with alpha: what was there before would be seen behind
  std::string complaint_;
};

}  // namespace knotreel::video
