#include "stream_source.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "colour_rules.h"
#include "knotreel/base/error.h"

namespace knotreel::video {
namespace {

/// libav's own VP8 and VP9 decoders know nothing of the alpha that WebM may have beside the picture.
const AVCodec* decoder_for(const AVStream& stream) {
  const AVCodecID id = stream.codecpar->codec_id;
  const AVDictionaryEntry* alpha = av_dict_get(stream.metadata, "alpha_mode", nullptr, 0);
  if (alpha != nullptr && std::string(alpha->value) == "1") {
    const char* name = id == AV_CODEC_ID_VP9 ? "libvpx-vp9" : id == AV_CODEC_ID_VP8 ? "libvpx" : "";
    if (const AVCodec* codec = avcodec_find_decoder_by_name(name)) return codec;
  }
  return avcodec_find_decoder(id);
}

/// Raw streams are cut into packets by a parser, whose times are guesses; rawvideo knows its rate.
bool has_times(const AVInputFormat& format, const AVFrame& first) {
  if ((format.flags & AVFMT_NOTIMESTAMPS) != 0 || reads_pictures(format)) return false;
  const bool raw = format.raw_codec_id != AV_CODEC_ID_NONE && format.raw_codec_id != AV_CODEC_ID_RAWVIDEO;
  return !raw && first.best_effort_timestamp != AV_NOPTS_VALUE;
}

/// When a track ends, in seconds; 0 if it is not told. In Matroska, "00:01:02.345000000" in its tags.
double told_end(const AVStream& stream) {
  if (stream.duration > 0 && stream.start_time != AV_NOPTS_VALUE) {
    return double(stream.start_time + stream.duration) * av_q2d(stream.time_base);
  }
  const AVDictionaryEntry* entry = av_dict_get(stream.metadata, "DURATION", nullptr, 0);
  int hours = 0, minutes = 0;
  double seconds = 0;
  if (entry == nullptr || std::sscanf(entry->value, "%d:%d:%lf", &hours, &minutes, &seconds) != 3) return 0;
  return 3600.0 * hours + 60.0 * minutes + seconds;
}

}  // namespace

StreamSource::StreamSource(const std::string& input, const ReadOptions& options)
    : demuxer_(input, options), strict_(options.strict) {
  open_decoder(options.threads);
  if (const int others = demuxer_.other_videos(); others > 0) {
    warnings_.add(std::to_string(others) + " more video streams are left out");
  }
  ahead_ = decode();
  if (!ahead_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "no frame of it can be decoded");
  describe();
  describe_time(options);
  stamp(*ahead_);
  to_image_.emplace(info_.width, info_.height, info_.channels);
}

void StreamSource::open_decoder(int threads) {
  const AVStream& stream = *demuxer_.video();
  const AVCodec* codec = decoder_for(stream);
  const std::string name = avcodec_get_name(stream.codecpar->codec_id);
  if (codec == nullptr)
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "no decoder for '" + name + "'");
  decoder_.reset(allocated(avcodec_alloc_context3(codec)));
  if (avcodec_parameters_to_context(decoder_.get(), stream.codecpar) < 0) throw std::bad_alloc();
  decoder_->pkt_timebase = stream.time_base;
  decoder_->framerate = stream.avg_frame_rate;
  decoder_->thread_count = threads;
  decoder_->max_pixels = std::int64_t(image::kMaxPixels);
  if (strict_) decoder_->err_recognition |= AV_EF_EXPLODE | AV_EF_CAREFUL;
  const int result = avcodec_open2(decoder_.get(), codec, nullptr);
  if (result < 0) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "decoder '" + name + "': " + error_text(result));
  }
}

void StreamSource::describe() {
  const AVFrame& frame = *ahead_;
  const auto format = AVPixelFormat(frame.format);
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
  info_.width = frame.width;
  info_.height = frame.height;
  if (std::uint64_t(frame.width) * std::uint64_t(frame.height) > image::kMaxPixels) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "its frames have too many pixels");
  }
  info_.channels = channels_of(description);
  info_.depth = depth_of(description);
  info_.pixel_format = description.name;
  info_.codec = avcodec_get_name(decoder_->codec_id);
  info_.container = demuxer_.format()->iformat->name;
  info_.colour.range = without_range(format) != format ? int(AVCOL_RANGE_JPEG) : int(frame.color_range);
  info_.colour.matrix = is_rgb(description) ? int(AVCOL_SPC_UNSPECIFIED) : int(frame.colorspace);
  info_.colour.primaries = frame.color_primaries;
  info_.colour.transfer = frame.color_trc;
  info_.colour.chroma_location = frame.chroma_location;
  AVStream* stream = demuxer_.video();
  info_.sample_aspect = from_av(av_guess_sample_aspect_ratio(demuxer_.format(), stream, ahead_.get()));
  std::size_t size = 0;
  const std::uint8_t* matrix = av_stream_get_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, &size);
  if (matrix != nullptr) {
    const auto* bytes = reinterpret_cast<const std::byte*>(matrix);
    info_.display_matrix.assign(bytes, bytes + size);
  }
}

void StreamSource::describe_time(const ReadOptions& options) {
  AVFormatContext* format = demuxer_.format();
  AVStream* stream = demuxer_.video();
  info_.still = reads_pictures(*format->iformat) && stream->nb_frames <= 1 && format->pb != nullptr &&
                (format->pb->seekable & AVIO_SEEKABLE_NORMAL) != 0;
  info_.timestamps = has_times(*format->iformat, *ahead_);
  info_.frame_rate = from_av(av_guess_frame_rate(format, stream, nullptr));
  const bool told = options.demuxer_options.contains("framerate");
  if (!info_.timestamps && !told && decoder_->framerate.num > 0) {
    info_.frame_rate = from_av(decoder_->framerate);
  }
  if (reads_pictures(*format->iformat) && !told) info_.frame_rate = options.image_rate;
  info_.time_base = from_av(stream->time_base);
  if (!info_.timestamps) {
    if (!info_.frame_rate.known()) info_.frame_rate = {25, 1};
    info_.time_base = {info_.frame_rate.den, info_.frame_rate.num};
  }
  if ((format->iformat->flags & AVFMT_TS_DISCONT) != 0 && info_.timestamps &&
      format->start_time != AV_NOPTS_VALUE) {
    info_.start = av_rescale_q(format->start_time, AVRational{1, AV_TIME_BASE}, stream->time_base);
  }
  if (stream->duration > 0) {
    info_.seconds = double(stream->duration) * av_q2d(stream->time_base);
  } else if (format->duration > 0) {
    info_.seconds = double(format->duration) / AV_TIME_BASE;
  }
  info_.frames = stream->nb_frames > 0 ? std::uint64_t(stream->nb_frames)
                                       : std::uint64_t(std::lround(info_.seconds * info_.frame_rate.value()));
  if (info_.still) info_.frames = 1;
}

std::vector<int> StreamSource::copied_streams() const {
  std::vector<int> streams;
  for (unsigned i = 0; i < format()->nb_streams; ++i) {
    if (demuxer_.copied(int(i))) streams.push_back(int(i));
  }
  return streams;
}

void StreamSource::damage(const std::string& why) {
  ++damaged_;
  if (strict_) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "damaged after frame " +
                                       std::to_string(decoded_) + " (" + why + ")");
  }
  warnings_.count("packets or frames are damaged and left out");
}

FramePtr StreamSource::decode() {
  while (!drained_) {
    if (FramePtr frame = receive()) return frame;
    if (!drained_) feed();
  }
  return {};
}

/// A frame if the decoder has one; otherwise it wants more, or is at its end.
FramePtr StreamSource::receive() {
  for (;;) {
    FramePtr frame = new_frame();
    const int result = avcodec_receive_frame(decoder_.get(), frame.get());
    if (result >= 0) {
      ++decoded_;
      // The decoder has filled in what was missing; that is better than a gap.
      if (frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
        if (strict_) damage("wrong in itself");
        ++damaged_;
        warnings_.count("damaged frames are shown as the decoder mended them");
      }
      return frame;
    }
    if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
    if (result == AVERROR_EOF) drained_ = true;
    if (result == AVERROR_EOF || result == AVERROR(EAGAIN)) return {};
    damage(error_text(result));
  }
}

void StreamSource::feed() {
  std::string why;
  PacketPtr packet = demuxer_.read(why);
  if (!why.empty()) {
    if (strict_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + why);
    warnings_.add("the input ends early: " + why);
    cut_short_ = true;
  }
  if (!packet) {
    avcodec_send_packet(decoder_.get(), nullptr);
    return;
  }
  if (packet->stream_index == demuxer_.video_index()) {
    take_video(std::move(packet));
  } else {
    const AVRational time_base = demuxer_.format()->streams[packet->stream_index]->time_base;
    packets_.emplace_back(std::make_shared<const CopiedPacket>(CopiedPacket{std::move(packet), time_base}));
  }
}

void StreamSource::take_video(PacketPtr packet) {
  if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0) {
    damage("cut short");
    return;
  }
  const int result = avcodec_send_packet(decoder_.get(), packet.get());
  if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
  if (result < 0 && result != AVERROR(EAGAIN) && result != AVERROR_EOF) damage(error_text(result));
}

/// Gives a frame its time, which goes up from frame to frame.
void StreamSource::stamp(AVFrame& frame) {
  const std::int64_t step = std::max<std::int64_t>(last_duration_, 1);
  std::int64_t pts = frame.best_effort_timestamp;
  if (!info_.timestamps) {
    pts = last_pts_ == AV_NOPTS_VALUE ? 0 : last_pts_ + 1;
    frame.pkt_duration = 1;
  } else if (pts == AV_NOPTS_VALUE) {
    pts = last_pts_ == AV_NOPTS_VALUE ? 0 : last_pts_ + step;
    warnings_.count("frames have no time; it is made from the frame before");
  } else if (last_pts_ != AV_NOPTS_VALUE && pts <= last_pts_) {
    pts = last_pts_ + step;
    warnings_.count("frames go back in time; they are put after the frame before");
  }
  frame.pts = pts;
  last_pts_ = pts;
  last_duration_ = duration_of(frame);
}

std::int64_t StreamSource::duration_of(const AVFrame& frame) const {
  if (frame.pkt_duration > 0) return frame.pkt_duration;
  if (!info_.frame_rate.known()) return 0;
  return av_rescale_q(1, av_inv_q(to_av(info_.frame_rate)), to_av(info_.time_base));
}

/// What stands beside the last frame may be nothing (Matroska), or the time until the next frame to be
/// decoded (mp4); the end of the track tells better.
std::int64_t StreamSource::last_duration(const AVFrame& frame) const {
  const std::int64_t usual = duration_of(frame);
  const double end = told_end(*demuxer_.video());
  if (end <= 0 || usual <= 0) return usual;
  const std::int64_t told = std::llround(end / info_.time_base.value()) - frame.pts;
  return told > usual / 4 && told < usual * 4 ? told : usual;
}

/// Most demuxers take a file that is cut short for one that ends there.
void StreamSource::check_end() {
  const double end = told_end(*demuxer_.video());
  if (!info_.timestamps || demuxer_.format()->duration_estimation_method == AVFMT_DURATION_FROM_BITRATE)
    return;
  const double tick = info_.time_base.value();
  const double missing = end - double(last_pts_ + last_duration_) * tick;
  if (missing < std::max(0.2, 3 * double(last_duration_) * tick) || cut_short_) return;
  const std::string why = "it tells of " + std::to_string(missing) + " s more";
  if (strict_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + why);
  warnings_.add("the input ends early: " + why);
}

void StreamSource::look_ahead() {
  ahead_ = decode();
  if (!ahead_) {
    check_end();
    return;
  }
  if (ahead_->width != info_.width || ahead_->height != info_.height) {
    warnings_.count("frames are of another size than the first, and scaled to it");
  }
  stamp(*ahead_);
}

bool StreamSource::next(Frame& frame) {
  if (!ahead_) return false;
  const FramePtr current = std::move(ahead_);
  look_ahead();
  frame.image = to_image_->convert(*current);
  frame.index = handed_out_++;
  frame.pts = current->pts;
  frame.duration = ahead_ ? ahead_->pts - current->pts : last_duration(*current);
  frame.packets = take_packets();
  return true;
}

std::unique_ptr<Source> open_stream(const std::string& input, const ReadOptions& options) {
  return std::make_unique<StreamSource>(input, options);
}

}  // namespace knotreel::video
