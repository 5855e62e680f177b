// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <utility>

#include "demuxer.h"
#include "frame_filter.h"
#include "frame_to_image.h"
#include "source.h"

namespace knotreel::video {

/// Decodes a video stream, and filters it, one frame ahead of what it hands out: only the next frame tells
/// how long one lasts.
class StreamSource : public Source {
 public:
  StreamSource(const std::string& input, const ReadOptions& options);

  bool next(Frame& frame) override;
  bool skip(Frame& frame) override;
  bool seek(double seconds) override;
  std::vector<Packet> take_packets() override { return std::exchange(packets_, {}); }
  std::vector<Packet> packets_until(double seconds) override;
  AVFormatContext* format() const override { return demuxer_.format(); }
  int video_stream() const override { return demuxer_.video_index(); }
  std::vector<int> copied_streams() const override;
  bool copies_chapters() const override { return chapters_; }

 private:
  void open_decoder(int threads);
  void begin(const ReadOptions& options);
  FramePtr decode();
  FramePtr receive();
  FramePtr filtered();
  void feed();
  PacketPtr read_packet();
  void keep(PacketPtr packet);
  void pass_over(const AVPacket& packet);
  void take_gap();
  void look_for_gap(const AVPacket& packet);
  void take_video(PacketPtr packet);
  void damage(const std::string& why, const std::string& told = "packets or frames are damaged and left out");
  void stamp(AVFrame& frame);
  bool is_whole() const;
  std::int64_t last_duration(const AVFrame& frame) const;
  void look_ahead();
  void look_at(AVFrame& frame);
  bool decode_from(std::int64_t pts);
  FramePtr advance(Frame& frame);
  std::string what_is_missing() const;
  void check_end();

  /// Where packets of a transport stream are not numbered on.
  struct Gap {
    std::size_t joints;  ///< before it
    int packets = 0;     ///< of the video since
  };

  Demuxer demuxer_;
  bool strict_, chapters_;
  Complaints complaints_{0};  ///< of decoder_
  CodecPtr decoder_;
  StreamInfo decoded_info_;  ///< of frames before they are filtered
  std::optional<FrameFilter> filter_;
  std::optional<FrameToImage> to_image_;
  FramePtr ahead_;
  std::optional<Gap> gap_;  ///< that may be a joint
  std::vector<Packet> packets_;
  std::uint64_t decoded_ = 0, handed_out_ = 0;
  /// Frames before that time come from a seek: what they lack, because it lies before them, is no damage.
  std::int64_t shown_from_ = AV_NOPTS_VALUE;
  std::int64_t last_pts_ = AV_NOPTS_VALUE, last_duration_ = 0;  ///< before filters
  bool drained_ = false, filter_ended_ = false, cut_short_ = false;
  double clock_ = -std::numeric_limits<double>::infinity();  ///< of packets_until(), seconds
  bool packets_ended_ = false;                               ///< likewise
};

}  // namespace knotreel::video
