// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <istream>
#include <memory>
#include <string>

#include "file_end.h"
#include "joined_times.h"
#include "knotreel/video/reader.h"
#include "libav.h"
#include "pipe_io.h"

namespace knotreel::video {

/// An opened container with its video stream chosen. The streams that are neither the video nor copied are
/// discarded by libav.
class Demuxer {
 public:
  /// @throws Error{kInput} if it cannot be opened or has no video stream, Error{kInvalidArgument} for an
  /// unknown format or option.
  Demuxer(const std::string& input, const ReadOptions& options);

  AVFormatContext* format() const { return format_.get(); }
  AVStream* video() const { return format_->streams[video_]; }
  int video_index() const { return video_; }
  bool copied(int stream) const;
  /// Other video streams, which are left out.
  int other_videos() const;
  /// Pictures of what the file is about, which are no videos.
  int covers() const;

  /// The next packet of the video or of a copied stream; null at the end.
  /// @param why  set to what ended the file early; empty otherwise.
  PacketPtr read(std::string& why);

  /// How often the clock of what was read has started anew (JoinedTimes).
  std::size_t joints() const { return times_.joints(); }

  /// How many of them lie before the last packet of the video.
  std::size_t joints_before_video() const { return times_.joints_before(video_); }

  /// Whether what is read is numbered, so that it is told where something is missing: a transport stream.
  bool numbers_packets() const;

  /// Goes on with the last packet before a time from which the video can be decoded, if the file has an index
  /// of when frames are shown. @param pts ticks of the video stream. @return whether it did.
  bool seek(std::int64_t pts);

  /// Whether the file is as long as it tells, which read() does not find. To be asked when all is read.
  FileEnd end() const;

  /// What is read, once more; null if it is neither a regular file nor in memory.
  std::unique_ptr<std::istream> from_its_start() const;

  /// "cannot read video 'x': " or the same for standard input.
  const std::string& cannot_read() const { return cannot_read_; }

 private:
  struct Closer {
    void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
  };
  void open(const std::string& input, const ReadOptions& options);
  void choose_video();
  void discard_others();
  bool ends_in_a_frame() const;
  bool has_index() const;
  bool has_read_index() const;

  std::string input_, cannot_read_;
  std::unique_ptr<PipeIo> pipe_;  ///< if it is one; before what reads it
  std::unique_ptr<AVFormatContext, Closer> format_;
  int video_ = -1;
  std::int64_t packets_end_ = 0;             ///< of those read so far, bytes
  std::int64_t video_dts_ = AV_NOPTS_VALUE;  ///< of the last packet of the video
  bool copy_ = false;
  JoinedTimes times_;
};

/// Name of the demuxer's kind for single pictures, such as png_pipe.
bool reads_pictures(const AVInputFormat& format);

}  // namespace knotreel::video
