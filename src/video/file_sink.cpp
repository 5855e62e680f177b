// SPDX-License-Identifier: GPL-3.0-or-later
extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>

#include "colour_rules.h"
#include "copied_streams.h"
#include "knotreel/base/error.h"
#include "knotreel/video/reader.h"
#include "output_io.h"
#include "sink.h"
#include "video_encoder.h"

namespace knotreel::video {
namespace {

const AVOutputFormat& choose_container(const std::string& output, const std::string& wanted) {
  const std::string name = wanted.empty() && output == "-" ? "matroska" : wanted;
  const AVOutputFormat* format = name.empty() ? av_guess_format(nullptr, output.c_str(), nullptr)
                                              : av_guess_format(name.c_str(), nullptr, nullptr);
  if (format == nullptr && name.empty()) {
    throw Error(ErrorKind::kInvalidArgument,
                "'" + output + "' has no extension of a video container, such as .mp4");
  }
  if (format == nullptr) throw Error(ErrorKind::kInvalidArgument, "no container is called '" + name + "'");
  if ((format->flags & AVFMT_NOFILE) != 0) {
    throw Error(ErrorKind::kInvalidArgument,
                "container '" + std::string(format->name) + "' is not one file, and cannot be written");
  }
  return *format;
}

bool has_option(const AVOutputFormat& container, const char* name) {
  const AVClass* options = container.priv_class;
  return options != nullptr && av_opt_find(&options, name, nullptr, 0, AV_OPT_SEARCH_FAKE_OBJ) != nullptr;
}

bool is_quicktime(const AVOutputFormat& container) {
  return has_option(container, "video_track_timescale");
}

/// Matroska does not (5.1).
bool keeps_display_matrix(const AVOutputFormat& container) {
  return is_quicktime(container);
}

/// As libav's muxers take it: GIF hundredths of a second, APNG a fraction of seconds, both in 16 bits.
std::string final_delay(const AVOutputFormat& container, std::int64_t duration, AVRational unit) {
  constexpr int kMost = 65535;
  if (std::string_view(container.name) == "gif")
    return std::to_string(std::min<std::int64_t>(kMost, av_rescale_q(duration, unit, AVRational{1, 100})));
  AVRational seconds{kMost, 1};
  if (double(duration) * av_q2d(unit) < kMost)
    av_reduce(&seconds.num, &seconds.den, duration * unit.num, unit.den, kMost);
  return std::to_string(seconds.num) + "/" + std::to_string(seconds.den);
}

/// A container file with one encoded video stream and copied others.
class FileSink : public Sink {
 public:
  FileSink(const std::string& output, const StreamInfo& frames, const WriteOptions& options,
           const VideoReader* copied)
      : start_(frames.start),
        unit_(to_av(frames.time_base)),
        container_(choose_container(output, options.container)),
        encoder_(frames, options, container_),
        io_(output),
        container_options_(options.container_options) {
    const std::string encoder = std::string("encoder '") + encoder_.context().codec->name + "'";
    if (!encoder_.takes_crf()) warnings.add(encoder + " has no crf: it is not used");
    if (!encoder_.complaint().empty()) warnings.add(encoder + ": " + encoder_.complaint());
    if (options.pixel_format.empty()) warn_of_losses(frames);
    AVFormatContext* made = nullptr;
    if (avformat_alloc_output_context2(&made, &container_, nullptr, nullptr) < 0) throw std::bad_alloc();
    muxer_.reset(made);
    muxer_->pb = io_.context();
    muxer_->url = allocated(av_strdup(io_.url().c_str()));  // some read again what they have written
    muxer_->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
    make_video_stream(frames);
    if (copied != nullptr) copy_from(*copied->state().source);
    write_header();
  }

  void write(const image::Image& image, std::int64_t pts, std::int64_t duration) override {
    encoder_.write(image, pts, duration, warnings, receiver());
  }

  void write_packet(const Packet& packet) override {
    const PacketPtr prepared = copied_.prepare(packet, start_, unit_, *muxer_);
    if (prepared) check(av_interleaved_write_frame(muxer_.get(), prepared.get()));
  }

  void finish() override {
    encoder_.finish(receiver());
    write_last_packet();
    tell_last_duration();
    check(av_write_trailer(muxer_.get()));
    io_.commit();
  }

  std::string codec() const override { return avcodec_get_name(encoder_.context().codec_id); }
  std::string pixel_format() const override { return av_get_pix_fmt_name(encoder_.context().pix_fmt); }

 private:
  struct Deleter {
    void operator()(AVFormatContext* p) const {
      p->pb = nullptr;  // not libav's own
      avformat_free_context(p);
    }
  };

  AVStream& video() const { return *muxer_->streams[0]; }

  VideoEncoder::Receiver receiver() {
    return [this](AVPacket& packet) {
      packet.stream_index = 0;
      av_packet_rescale_ts(&packet, encoder_.time_base(), video().time_base);
      if (!is_quicktime(container_)) return check(av_interleaved_write_frame(muxer_.get(), &packet));
      if (last_packet_) {
        written_dts_ = last_packet_->dts;
        check(av_interleaved_write_frame(muxer_.get(), last_packet_.get()));
      } else {
        first_dts_ = packet.dts;
        first_pts_ = packet.pts;
        last_packet_ = new_packet();
      }
      end_ = std::max(end_, packet.pts + packet.duration);
      av_packet_move_ref(last_packet_.get(), &packet);
    };
  }

  /// libav takes what is beside the last packet for how long that is shown, and players of QuickTime add up
  /// the times from each packet to the next in the order of decoding. Both come to the end of the last frame
  /// if this packet, which may be of another one, is decoded as long before it is shown as the first is;
  /// where the packet before it is in the way, only libav's does, by which the movie ends.
  void write_last_packet() {
    if (!last_packet_) return;
    const std::int64_t best = last_packet_->pts - (first_pts_ - first_dts_);
    if (written_dts_ != AV_NOPTS_VALUE) last_packet_->dts = std::max(best, written_dts_ + 1);
    last_packet_->duration = end_ - last_packet_->pts;
    check(av_interleaved_write_frame(muxer_.get(), last_packet_.get()));
  }

  /// The muxers of GIF and APNG go by when the next frame comes.
  void tell_last_duration() {
    constexpr const char* kOption = "final_delay";
    const std::int64_t duration = encoder_.last_duration();
    if (duration <= 0 || !has_option(container_, kOption) || container_options_.contains(kOption)) return;
    const std::string delay = final_delay(container_, duration, encoder_.time_base());
    av_opt_set(muxer_->priv_data, kOption, delay.c_str(), 0);
  }

  /// @throws what the file threw, or an error of libav's
  void check(int result) const {
    io_.rethrow();
    if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
    if (result < 0) throw Error(ErrorKind::kOutput, "cannot write " + io_.name() + ": " + error_text(result));
  }

  /// What the nearest pixel format cannot hold, or who cannot show it.
  void warn_of_losses(const StreamInfo& frames) {
    const AVPixelFormat format = encoder_.context().pix_fmt;
    const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
    const std::string name = std::string("pixel format '") + av_get_pix_fmt_name(format) + "' has ";
    if (frames.channels % 2 == 0 && !has_alpha(description)) {
      warnings.add(name +
                   "no alpha: frames are put on black (or on --background; vp9, ffv1 and prores keep alpha)");
    }
    if (frames.channels % 2 == 0 && format == AV_PIX_FMT_PAL8) {
      warnings.add(name + "alpha all or nothing: what is half transparent or more is left out");
    }
    if (frames.depth > 8 && depth_of(description) == 8) {
      warnings.add(name + "8 bits: the " + std::to_string(frames.depth) + " of the pictures are rounded");
    }
    const AVCodecID codec = encoder_.context().codec_id;
    const bool is_played =
        is_quicktime(container_) && (codec == AV_CODEC_ID_H264 || codec == AV_CODEC_ID_HEVC);
    if (is_played && !is_grey(description) && description.log2_chroma_w == 0) {
      const bool even = frames.width % 2 == 0 && frames.height % 2 == 0;
      warnings.add(name + "colours at full size, which many players cannot show; " +
                   (even ? "--pixel-format yuv420p is for those" : "even sizes may have yuv420p"));
    }
  }

  void make_video_stream(const StreamInfo& frames) {
    AVStream* stream = allocated(avformat_new_stream(muxer_.get(), nullptr));
    if (avcodec_parameters_from_context(stream->codecpar, &encoder_.context()) < 0) throw std::bad_alloc();
    stream->time_base = encoder_.time_base();
    stream->sample_aspect_ratio = to_av(frames.sample_aspect);
    if (frames.frame_rate.known()) stream->avg_frame_rate = stream->r_frame_rate = to_av(frames.frame_rate);
    const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(encoder_.context().pix_fmt);
    if ((format->flags & AV_PIX_FMT_FLAG_ALPHA) != 0) av_dict_set(&stream->metadata, "alpha_mode", "1", 0);
    if (!frames.display_matrix.empty()) keep_rotation(*stream, frames.display_matrix);
  }

  void keep_rotation(AVStream& stream, const std::vector<std::byte>& matrix) {
    if (!keeps_display_matrix(container_)) {
      warnings.add("container '" + std::string(container_.name) +
                   "' does not keep the rotation of the picture");
      return;
    }
    auto* bytes = av_stream_new_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, matrix.size());
    std::memcpy(allocated(bytes), matrix.data(), matrix.size());
  }

  void copy_from(const Source& source) {
    AVDictionary* own = nullptr;
    av_dict_copy(&own, video().metadata, 0);
    copy_video_properties(source, video());
    av_dict_copy(&video().metadata, own, 0);
    av_dict_free(&own);
    copied_.make(source, *muxer_, warnings);
  }

  void write_header() {
    const AVCodecID codec = encoder_.context().codec_id;
    Options options;
    if (is_quicktime(container_)) {
      // Ticks as fine as the source's, also where the tracks begin; sound begins between ticks of a few.
      constexpr int kFewTicks = 10000;
      const int ticks = encoder_.time_base().den;
      const int parts = ticks < kFewTicks ? (kFewTicks + ticks - 1) / ticks : 1;
      options.set("video_track_timescale", std::to_string(ticks));
      options.set("movie_timescale", std::to_string(ticks * parts));
      if (!io_.seekable()) options.set("movflags", "frag_keyframe+delay_moov+default_base_moof");
    }
    // Moving pictures go on for ever, as GIFs do by themselves.
    for (const char* times : {"loop", "plays"}) {
      if (has_option(container_, times)) options.set(times, "0");
    }
    for (const auto& [key, value] : container_options_) {
      const bool adds = key == "movflags" && value.starts_with('+');
      options.set(key, adds ? options.value(key) + value : value);
    }
    const LogListener listener;
    const int result = avformat_write_header(muxer_.get(), options.get());
    io_.rethrow();
    if (result < 0) {
      const std::string& told = listener.first_error();
      throw Error(ErrorKind::kInvalidArgument, std::string("container '") + container_.name +
                                                   "' does not take " + avcodec_get_name(codec) +
                                                   " video: " + (told.empty() ? error_text(result) : told));
    }
    for (const auto& [key, value] : container_options_) {
      if (!options.contains(key)) continue;
      throw Error(ErrorKind::kInvalidArgument,
                  std::string("container '") + container_.name + "' has no option '" + key + "'");
    }
  }

  std::int64_t start_;
  AVRational unit_;
  const AVOutputFormat& container_;
  VideoEncoder encoder_;
  OutputIo io_;
  std::map<std::string, std::string> container_options_;
  std::unique_ptr<AVFormatContext, Deleter> muxer_;
  CopiedStreams copied_;
  PacketPtr last_packet_;  // of QuickTime, in the order of decoding; with times of the muxer, like these:
  std::int64_t first_dts_ = 0, first_pts_ = 0, end_ = 0, written_dts_ = AV_NOPTS_VALUE;
};

}  // namespace

bool keeps_rotation(const std::string& output, const WriteOptions& options) {
  return keeps_display_matrix(choose_container(output, options.container));
}

std::unique_ptr<Sink> make_file_sink(const std::string& output, const StreamInfo& frames,
                                     const WriteOptions& options, const VideoReader* copied) {
  return std::make_unique<FileSink>(output, frames, options, copied);
}

}  // namespace knotreel::video
