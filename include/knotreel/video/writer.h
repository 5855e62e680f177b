// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/image/image.h"
#include "knotreel/video/packet.h"
#include "knotreel/video/stream_info.h"

namespace knotreel::video {

class Sink;
class VideoReader;

struct WriteOptions {
  std::string codec;      ///< h264, hevc, vp9, av1, ffv1, prores, or libav's name; empty: by the container
  double crf = -1;        ///< quality on the encoder's own scale, lower is better; below 0: its default here
  std::string preset;     ///< of the encoder, such as "slow"; of libaom: a number, its cpu-used
  std::string container;  ///< libav's name, or "null" or "hash"; empty: by the extension, `-`: matroska
  int threads = 0;  ///< for encoding, 0: all cores. x264's bytes depend on it, the pictures' quality not
  std::string pixel_format;                  ///< libav's name; empty: nearest to the source's
  std::optional<image::SampleType> samples;  ///< of pictures; none: as deep as the source, if they can be
  /// By libav's names, over all that is chosen here; a rate ("b") in place of the default crf. Those of
  /// x264-params and x265-params are added to what is given here.
  std::map<std::string, std::string> encoder_options;
  std::map<std::string, std::string> container_options;  ///< by libav's names, such as movflags
};

/// Writes a video. One thread at a time.
///
/// A file is written aside and gets its name in finish(). Without finish() nothing is left of it; after an
/// interruption finish() makes what has been written so far a whole, playable file. `-` is standard output.
/// Names with `%04d` are one picture per frame, from number 1 on, which appear one by one.
/// Rotation is kept where players find it, in mp4 and mov; elsewhere pictures are turned on their way.
/// The container "null" only counts, "hash" makes a digest of all samples and times.
class VideoWriter {
 public:
  /// @param frames  what the frames are: size, channels, depth, pixel format, time base, rate, tags.
  /// @param copied  the reader whose other streams are to be copied; only needed during this call.
  /// @throws Error{kInvalidArgument} for a codec, container, pixel format, option or size that cannot be,
  /// Error{kOutput} if the file cannot be written.
  static VideoWriter create(const std::string& output, const StreamInfo& frames,
                            const WriteOptions& options = {}, const VideoReader* copied = nullptr);
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  ~VideoWriter();

  /// @param image     of the size and the channels told in create().
  /// @param pts       ticks, above those of the frame before.
  /// @param duration  ticks; 0 if unknown.
  /// @throws Error{kOutput}, for a full disk for instance; Error{kInvalidArgument} for a wrong shape or time.
  void write(const image::Image& image, std::int64_t pts, std::int64_t duration);

  /// Packets as the reader gave them out; those of streams that are left out are passed over.
  /// @throws Error{kOutput}; Error{kInvalidArgument} after finish().
  void write_packets(const std::vector<Packet>& packets);

  /// Completes the file and gives it its name. Nothing may be written afterwards. @throws Error{kOutput}.
  void finish();

  /// What could not be kept, one line each: streams that the container does not take, rotation, times.
  const std::vector<std::string>& warnings() const;

  /// After finish(): "sha256:..." for the container "hash", else empty. Samples count as 8 bits if the source
  /// has no more, else as 16.
  std::string digest() const;

  /// Names of what was chosen, for reports; empty for null and hash.
  std::string codec() const;
  std::string pixel_format() const;

 private:
  explicit VideoWriter(std::unique_ptr<Sink> sink);
  std::unique_ptr<Sink> sink_;
};

}  // namespace knotreel::video
