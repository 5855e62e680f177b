// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "knotreel/base/turn.h"
#include "knotreel/video/writer.h"
#include "warnings.h"

namespace knotreel::video {

/// Where frames go. Shapes and times have been checked.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(const image::Image& image, std::int64_t pts, std::int64_t duration) = 0;
  virtual void write_packet(const Packet&) {}
  virtual void finish() = 0;
  virtual std::string digest() const { return {}; }
  virtual std::string codec() const { return {}; }
  virtual std::string pixel_format() const { return {}; }

  StreamInfo info;  ///< of the frames given, before they are turned
  Turn turn;        ///< what the sink cannot tell a player to do
  Warnings warnings;
  bool started = false, finished = false;
  std::int64_t last_pts = 0;
};

std::unique_ptr<Sink> make_null_sink();
std::unique_ptr<Sink> make_hash_sink(const StreamInfo& frames);
/// @param output  a name with %d in it, or the name of a single picture.
std::unique_ptr<Sink> make_picture_sink(const std::string& output, const StreamInfo& frames,
                                        const WriteOptions& options);
/// Whether a file of make_file_sink() tells players how to turn its pictures.
bool keeps_rotation(const std::string& output, const WriteOptions& options);
std::unique_ptr<Sink> make_file_sink(const std::string& output, const StreamInfo& frames,
                                     const WriteOptions& options, const VideoReader* copied);

}  // namespace knotreel::video
