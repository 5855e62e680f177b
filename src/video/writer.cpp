// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/video/writer.h"

#include <filesystem>

#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/video/picture_list.h"
#include "knotreel/video/turn.h"
#include "libav.h"
#include "sink.h"

namespace knotreel::video {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

void check_info(const StreamInfo& frames) {
  if (frames.width < 1 || frames.height < 1 || frames.channels < 1 || frames.channels > 4) {
    refuse("frames need a size, and 1 to 4 channels");
  }
  if (!frames.time_base.known()) refuse("frames need a time base above 0");
}

bool names_picture(const std::string& output) {
  const std::string extension = std::filesystem::path(output).extension().string();
  return number_pattern(output) || (!extension.empty() && image::format_of_extension(extension.substr(1)));
}

bool is_for_pictures(const std::string& output, const WriteOptions& options) {
  return options.container.empty() && names_picture(output);
}

/// What is to be done to the pictures themselves. Digests are of frames as they are.
Turn turn_for(const std::string& output, const StreamInfo& frames, const WriteOptions& options) {
  if (options.container == "null" || options.container == "hash") return {};
  if (!is_for_pictures(output, options) && keeps_rotation(output, options)) return {};
  return turn_of(frames);
}

std::unique_ptr<Sink> make_sink(const std::string& output, const StreamInfo& frames,
                                const WriteOptions& options, const VideoReader* copied) {
  if (options.container == "null") return make_null_sink();
  if (options.container == "hash") return make_hash_sink(frames);
  if (is_for_pictures(output, options)) return make_picture_sink(output, frames, options);
  return make_file_sink(output, frames, options, copied);
}

bool asks_for_encoding(const WriteOptions& options) {
  return !options.codec.empty() || options.crf >= 0 || !options.preset.empty() ||
         !options.pixel_format.empty() || !options.encoder_options.empty() ||
         !options.container_options.empty();
}

}  // namespace

VideoWriter VideoWriter::create(const std::string& output, const StreamInfo& frames,
                                const WriteOptions& options, const VideoReader* copied) {
  silence_libav();
  check_info(frames);
  const Turn turn = turn_for(output, frames, options);
  std::unique_ptr<Sink> sink = make_sink(output, turned(frames, turn), options, copied);
  sink->info = frames;
  sink->turn = turn;
  if (sink->codec().empty() && asks_for_encoding(options)) {
    sink->warnings.add(
        "codec, quality, preset, pixel format and options of encoder and container are not used: this output "
        "is no encoded video");
  }
  return VideoWriter(std::move(sink));
}

VideoWriter::VideoWriter(std::unique_ptr<Sink> sink) : sink_(std::move(sink)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const image::Image& image, std::int64_t pts, std::int64_t duration) {
  Sink& sink = *sink_;
  const StreamInfo& info = sink.info;
  if (sink.finished) refuse("a frame comes after the end of the video");
  if (image.width != info.width || image.height != info.height || image.channels != info.channels) {
    refuse("a frame has not the size or the channels of the video");
  }
  image::check_image(image);
  if (sink.started && pts <= sink.last_pts) refuse("the time of a frame is not after the frame before");
  sink.started = true;
  sink.last_pts = pts;
  if (sink.turn.is_none()) {
    sink.write(image, pts, duration);
  } else {
    sink.write(turned(image, sink.turn), pts, duration);
  }
}

void VideoWriter::write_packets(const std::vector<Packet>& packets) {
  if (sink_->finished) refuse("a packet comes after the end of the video");
  for (const Packet& packet : packets) sink_->write_packet(packet);
}

void VideoWriter::finish() {
  if (sink_->finished) return;
  sink_->finished = true;
  sink_->finish();
}

const std::vector<std::string>& VideoWriter::warnings() const {
  return sink_->warnings.lines();
}

std::string VideoWriter::digest() const {
  return sink_->digest();
}

std::string VideoWriter::codec() const {
  return sink_->codec();
}

std::string VideoWriter::pixel_format() const {
  return sink_->pixel_format();
}

}  // namespace knotreel::video
