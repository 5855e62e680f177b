// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "knotreel/video/reader.h"
#include "libav.h"
#include "warnings.h"

namespace knotreel::video {

/// Where frames come from: a stream of libav, or a list of pictures.
class Source {
 public:
  virtual ~Source() = default;
  virtual bool next(Frame& frame) = 0;
  /// The same, but the picture of the frame is not wanted.
  virtual bool skip(Frame& frame) { return next(frame); }
  /// Leaves out frames, and packets, that are well before a time and not handed out yet, if that is quicker
  /// than to skip() them. @param seconds on the clock of the file. @return whether some were left out.
  virtual bool seek(double /*seconds*/) { return false; }
  virtual std::vector<Packet> take_packets() { return {}; }
  virtual std::vector<Packet> packets_until(double) { return {}; }
  /// For copying streams; null if there are none.
  virtual AVFormatContext* format() const { return nullptr; }
  /// Number of the video stream in format().
  virtual int video_stream() const { return -1; }
  /// Numbers of the streams in format() whose packets are handed out.
  virtual std::vector<int> copied_streams() const { return {}; }
  /// Whether chapters are copied, too.
  virtual bool copies_chapters() const { return false; }

  const StreamInfo& info() const { return info_; }
  virtual const Warnings& warnings() const { return warnings_; }
  virtual std::uint64_t damaged() const { return damaged_; }

 protected:
  StreamInfo info_;
  Warnings warnings_;
  std::uint64_t damaged_ = 0;
};

/// What a VideoReader holds, and what a writer that copies its streams looks at.
struct ReaderState {
  std::unique_ptr<Source> source;
};

/// A file, pipe or URL; with one frame only if it is a picture.
std::unique_ptr<Source> open_stream(const std::string& input, const ReadOptions& options);

/// Pictures, one frame each.
/// @param missing  how many there should be besides; only told of.
std::unique_ptr<Source> open_pictures(std::vector<std::string> files, const ReadOptions& options,
                                      std::uint64_t missing = 0);

/// Some frames of a source, and the packets of the time in which they are shown.
/// @throws Error{kInvalidArgument} if there is no such frame.
std::unique_ptr<Source> open_part(std::unique_ptr<Source> whole, const Part& part);

}  // namespace knotreel::video
