// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/video/packet.h"
#include "knotreel/video/stream_info.h"

namespace knotreel::video {

struct Frame {
  image::Image image;
  std::uint64_t index = 0;      ///< 0, 1, 2, ...
  std::int64_t pts = 0;         ///< ticks of the time base; always above that of the frame before
  std::int64_t duration = 0;    ///< ticks until the next frame; what the container says of the last one
  std::vector<Packet> packets;  ///< of the copied streams, read since the frame before
};

/// What is wanted of a video: frames by their numbers, or by their times. Those before are decoded and passed
/// over, but for what an index of the file tells of times (MP4, Matroska), unless strict; of copied streams
/// the same time is kept.
struct Part {
  std::uint64_t first = 0;  ///< number of the frame to begin with
  std::uint64_t count = 0;  ///< of frames, at most; 0: up to the end
  double start = 0;         ///< of earlier frames none; seconds from the first frame of the video on
  double end = std::numeric_limits<double>::infinity();  ///< of frames from here on none

  friend bool operator==(const Part&, const Part&) = default;
};

/// What becomes of interlaced frames, which hold the lines of two moments in turns.
enum class Deinterlace : std::uint8_t {
  kNone,    ///< they stay as they are
  kMarked,  ///< of those that the video says are interlaced, the first moment is shown
  kAll,     ///< likewise, of all frames, whatever the video says
  kFields,  ///< both moments of all frames are shown: twice as many, at twice the rate
};

struct ReadOptions {
  int threads = 0;           ///< for decoding; 0: as many as there are cores
  bool strict = false;       ///< damage is an error
  bool copy_streams = true;  ///< hand out the packets of sound and subtitles
  bool chapters = true;      ///< of the file go where its streams are copied to
  std::string format;        ///< libav's name of the input format; empty: found by content
  std::map<std::string, std::string> demuxer_options;  ///< such as video_size, framerate, pixel_format
  Rational image_rate{25, 1};                          ///< of pictures
  Deinterlace deinterlace = Deinterlace::kMarked;      ///< pictures are never deinterlaced
  std::string filter;  ///< filters of libavfilter for decoded frames, as `ffmpeg -vf` takes them; empty: none
  Part part;           ///< all, if not told otherwise
};

inline constexpr std::size_t kPictureStart = 4096;  ///< bytes that are enough for holds_one_picture()

/// Whether a file holds one picture of a kind that the module image reads: animated PNG and, told by the
/// extensions .mjpeg and .mjpg, streams of JPEG pictures are videos.
/// @param start its first kPictureStart bytes, or all if it is shorter. @param name of the file.
bool holds_one_picture(std::span<const std::byte> start, const std::string& name);

struct ReaderState;

/// Reads a video from its start to its end. One thread at a time for each object; several objects may work at
/// once. libav's own messages are silenced for the whole process.
class VideoReader {
 public:
  /// Opens a video and decodes its first frames.
  /// @param input  a file of any kind that libav reads; a URL; `-`, standard input, which may be a pipe; a
  ///               picture; a folder of pictures or a pattern with `*`, `?` or `[...]`, taken in natural
  ///               order; a pattern with one `%d` or `%04d`, taken by number. Frames are brought to the size
  ///               of the first one.
  /// @throws Error{kInput} if there is nothing that can be decoded, Error{kInvalidArgument} for options that
  /// the format does not know, for filters that are none or for pictures, and for a part without a frame.
  static VideoReader open(const std::string& input, const ReadOptions& options = {});
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;
  ~VideoReader();

  /// Of the frames that next() hands out, known from open() on: of the part that was asked for, after filters
  /// and deinterlacing. Valid as long as the reader.
  const StreamInfo& info() const;

  /// All streams of the file; pictures have none.
  std::vector<StreamEntry> streams() const;

  /// The next frame; false at the end. Damaged frames are left out, which makes the frame before longer.
  /// @throws Error{kInput} for damage if strict.
  bool next(Frame& frame);

  /// Packets of copied streams that were read after the last frame. Call it when next() has said false.
  std::vector<Packet> remaining_packets();

  /// Packets of copied streams alone, for those who have the pictures from elsewhere: what the file has up to
  /// the first packet of a later time, that one included, and was not handed out before. Frames that have not
  /// been asked for by then are lost.
  /// @param seconds on the clock of the file; infinite: up to its end.
  /// @throws as next().
  std::vector<Packet> packets_until(double seconds);

  /// What was wrong without being an error, one line each: damage, changes of size, times made up.
  const std::vector<std::string>& warnings() const;

  /// Packets and frames that could not be decoded so far.
  std::uint64_t damaged() const;

  /// For VideoWriter: what it needs to know of the copied streams.
  const ReaderState& state() const { return *state_; }

 private:
  explicit VideoReader(std::unique_ptr<ReaderState> state);
  std::unique_ptr<ReaderState> state_;
};

}  // namespace knotreel::video
