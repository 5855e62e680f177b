// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "knotreel/video/packet.h"
#include "libav.h"
#include "source.h"
#include "warnings.h"

namespace knotreel::video {

/// The streams of a source that go into an output as they are.
class CopiedStreams {
 public:
  /// Makes streams in `output`, which has its video stream and no header yet, for what its container takes.
  /// What it does not take is told in the warnings. Chapters and titles go along.
  void make(const Source& source, AVFormatContext& output, Warnings& warnings);

  /// A packet as the muxer wants it, with its own times; null if its stream is left out. Bytes are shared.
  /// @param start, unit  what is taken away from the times.
  PacketPtr prepare(const Packet& packet, std::int64_t start, AVRational unit, const AVFormatContext& output);

 private:
  struct Target {
    int stream;
    std::int64_t last_dts;
  };
  std::map<int, Target> targets_;  // by the number in the source
};

/// Side data and metadata of the source's video stream that describe it as a whole: light levels, language.
void copy_video_properties(const Source& source, AVStream& video);

}  // namespace knotreel::video
