// SPDX-License-Identifier: GPL-3.0-or-later
#include "video_encoder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "carried_colours.h"
#include "colour_rules.h"
#include "encoder_choice.h"
#include "gif_alpha.h"
#include "image_to_frame.h"
#include "knotreel/base/error.h"
#include "webp_end.h"

namespace knotreel::video {
namespace {

/// MPEG-4 part 2 writes the time base in 16 bits.
constexpr int kMpeg4Ticks = 65535;
/// Seconds that a frame is repeated for at most: times of damaged files may lead anywhere.
constexpr double kLongestGap = 600;
/// libav lists lower ones for MPEG-1 and 2, which are not in the standard, and refuses them.
constexpr AVRational kLeastMpegRate{24000, 1001};

/// libav does not tell this reliably by a flag. Matroska, mp4, nut and the like keep any times.
bool has_fixed_rate(const AVOutputFormat& container) {
  const std::string name = container.name;
  return name == "avi" || name == "gxf" || name == "yuv4mpegpipe" || name.starts_with("mxf") ||
         (container.flags & AVFMT_NOTIMESTAMPS) != 0;
}

/// Whether readers count frames, whatever times they were written with.
bool counts_frames(const AVOutputFormat& container) {
  const std::string name = container.name;  // program streams: a time for some of the frames only
  return (container.flags & AVFMT_NOTIMESTAMPS) != 0 || name == "mpeg" || name == "vob" || name == "svcd" ||
         name == "dvd" || name == "vcd";
}

/// Whether a stream tells one rate, and its encoder takes ticks for frames.
bool has_fixed_rate(const AVCodecContext& encoder) {
  switch (encoder.codec_id) {
    case AV_CODEC_ID_THEORA:
    case AV_CODEC_ID_DIRAC:
    case AV_CODEC_ID_H261:
    case AV_CODEC_ID_H263:
    case AV_CODEC_ID_RV10:
    case AV_CODEC_ID_RV20:
    case AV_CODEC_ID_ROQ:
      return true;
    case AV_CODEC_ID_MPEG4:
      return encoder.time_base.den > kMpeg4Ticks;
    default:
      return false;
  }
}

/// The lowest rate of an encoder's list that is not too low, so that no frame is in the way of another one.
/// @throws Error{kInvalidArgument} if all are.
AVRational nearest_rate(const AVCodec& codec, AVRational rate) {
  AVRational nearest{0, 1}, highest{0, 1};
  for (const AVRational* known = codec.supported_framerates; known->num != 0; ++known) {
    if (av_cmp_q(*known, kLeastMpegRate) < 0) continue;
    if (av_cmp_q(*known, highest) > 0) highest = *known;
    if (av_cmp_q(*known, rate) >= 0 && (nearest.num == 0 || av_cmp_q(*known, nearest) < 0)) nearest = *known;
  }
  if (nearest.num != 0) return nearest;
  throw Error(ErrorKind::kInvalidArgument, std::string("encoder '") + codec.name + "' has no rate above " +
                                               std::to_string(std::lround(av_q2d(highest))) +
                                               " frames per second; this video has " +
                                               std::to_string(std::lround(av_q2d(rate))));
}

/// @param info of the frames: a failure takes a size away that libav does not allow.
/// @param told what libav's log says of it, if anything.
Error refused(const AVCodecContext& encoder, const StreamInfo& info, const std::string& name,
              const WriteOptions& options, int code, const std::string& told) {
  std::string what = "encoder '" + name + "' refuses " + std::to_string(info.width) + "x" +
                     std::to_string(info.height) + " " + av_get_pix_fmt_name(encoder.pix_fmt);
  if (!options.preset.empty()) what += ", preset '" + options.preset + "'";
  for (const auto& [key, value] : options.encoder_options) what += ", " + key + "=" + value;
  return Error(ErrorKind::kInvalidArgument, what + ": " + (told.empty() ? error_text(code) : told));
}

/// @throws Error{kInvalidArgument} for a user's option that the encoder has left.
void check_options(const Options& left, const std::string& encoder, const WriteOptions& options) {
  for (const auto& [key, value] : options.encoder_options) {
    if (!left.contains(key)) continue;
    throw Error(ErrorKind::kInvalidArgument, "encoder '" + encoder + "' has no option '" + key + "'");
  }
}

}  // namespace

VideoEncoder::VideoEncoder(const StreamInfo& frames, const WriteOptions& options,
                           const AVOutputFormat& container)
    : info_(frames) {
  const AVCodec* codec = choose_encoder(options.codec, container);
  encoder_.reset(allocated(avcodec_alloc_context3(codec)));
  info_.colour = carried_colours(frames.colour, codec->id, container);
  encoder_->width = frames.width;
  encoder_->height = frames.height;
  encoder_->pix_fmt = choose_pixel_format(*codec, frames, options.pixel_format);
  encoder_->sample_aspect_ratio = to_av(frames.sample_aspect);
  encoder_->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
  if ((container.flags & AVFMT_GLOBALHEADER) != 0) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  set_colours();
  set_times(container);
  open(options, container);
}

void VideoEncoder::set_colours() {
  const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(encoder_->pix_fmt);
  const ColourTags& tags = info_.colour;
  const bool ranged = without_range(encoder_->pix_fmt) != encoder_->pix_fmt;
  encoder_->color_range = ranged ? AVCOL_RANGE_JPEG : AVColorRange(tags.range);
  encoder_->color_primaries = AVColorPrimaries(tags.primaries);
  encoder_->color_trc = AVColorTransferCharacteristic(tags.transfer);
  encoder_->chroma_sample_location = AVChromaLocation(tags.chroma_location);
  const bool matrix = !is_rgb(format) && tags.matrix != AVCOL_SPC_RGB;
  encoder_->colorspace = matrix ? AVColorSpace(tags.matrix) : AVCOL_SPC_UNSPECIFIED;
}

void VideoEncoder::set_times(const AVOutputFormat& container) {
  const AVRational rate = info_.frame_rate.known() ? to_av(info_.frame_rate) : AVRational{25, 1};
  encoder_->framerate = rate;
  encoder_->time_base = to_av(info_.time_base);
  const bool has_list = encoder_->codec->supported_framerates != nullptr;
  if (has_list) encoder_->framerate = nearest_rate(*encoder_->codec, rate);
  fills_gaps_ = has_list && counts_frames(container);
  if (has_list || has_fixed_rate(container) || has_fixed_rate(*encoder_))
    encoder_->time_base = av_inv_q(encoder_->framerate);
  if (encoder_->codec_id == AV_CODEC_ID_MPEG4) {
    AVRational& unit = encoder_->time_base;  // that of an average rate may have any numbers
    av_reduce(&unit.num, &unit.den, unit.num, unit.den, kMpeg4Ticks);
  }
}

void VideoEncoder::open(const WriteOptions& options, const AVOutputFormat& container) {
  Options dictionary;
  const std::string name = encoder_->codec->name;  // a failure takes the codec away
  // Readers of transport streams know no rate but the stream's, and x264 would tell them its ticks for
  // frames.
  if (name == "libx264" && std::string_view(container.name) == "mpegts")
    dictionary.set("x264-params", "force-cfr=1");
  set_quality(*encoder_, dictionary, options);
  clears_ = name == "gif" && info_.channels % 2 == 0;
  is_webp_ = name == "libwebp_anim";
  if (clears_) dictionary.set("gifflags", "0");  // whole pictures
  if (name == "hap" && info_.channels % 2 == 0) dictionary.set("format", "hap_alpha");
  const LogListener listener;
  const int result = avcodec_open2(encoder_.get(), encoder_->codec, dictionary.get());
  if (result < 0) throw refused(*encoder_, info_, name, options, result, listener.first_error());
  check_options(dictionary, name, options);
  if (!options.encoder_options.empty()) complaint_ = listener.first_warning();
  takes_crf_ = !dictionary.contains("crf");
}

void VideoEncoder::write(const image::Image& image, std::int64_t pts, std::int64_t duration,
                         Warnings& warnings, const Receiver& receiver) {
  ColourTags tags = info_.colour;
  // As the encoder tells them: a user may have asked it for others.
  tags.range = encoder_->color_range;
  if (encoder_->colorspace != AVCOL_SPC_UNSPECIFIED) tags.matrix = encoder_->colorspace;
  const FramePtr frame = packed_frame(image, encoder_->pix_fmt, tags, info_.height, last_.get());
  frame->color_range = encoder_->color_range;
  frame->colorspace = encoder_->colorspace;
  frame->color_primaries = encoder_->color_primaries;
  frame->color_trc = encoder_->color_trc;
  frame->chroma_location = encoder_->chroma_sample_location;
  frame->sample_aspect_ratio = encoder_->sample_aspect_ratio;
  frame->quality = encoder_->global_quality;  // where AV_CODEC_FLAG_QSCALE is looked for
  const std::int64_t begin = pts - info_.start;
  if (last_pts_ == AV_NOPTS_VALUE) {
    first_pts_ = ticks_of(begin);
    first_time_ = begin;
  }
  frame->pts = ticks_of(begin) - cut_out_;
  if (last_pts_ != AV_NOPTS_VALUE) frame->pts = std::max(frame->pts, last_pts_ + 1);
  if (fills_gaps_) {
    cut_gap_before(*frame, warnings);
    repeat_until(frame->pts, receiver);
  }
  if (is_moved(frame->pts, begin)) {
    warnings.count("frames are moved in time, because this output has a fixed rate");
  }
  last_pts_ = frame->pts;
  last_end_ = std::max(ticks_of(begin + duration) - cut_out_, frame->pts);
  if (fills_gaps_) last_end_ = std::min(last_end_, frame->pts + most_repeats());
  durations_[frame->pts] = last_end_ - frame->pts;
  send(frame.get(), receiver);
  last_.reset(allocated(av_frame_clone(frame.get())));
}

/// A time of the source in ticks of the output, counted from the first frame, so that others do not come now
/// earlier, now later, if that one lies between two ticks. Held so far from the ends of 64 bits that sums of
/// some are not beyond them.
std::int64_t VideoEncoder::ticks_of(std::int64_t time) const {
  constexpr std::int64_t kMost = std::int64_t{1} << 61;
  const std::int64_t since = time - first_time_;
  const std::int64_t ticks = av_rescale_q(since, to_av(info_.time_base), time_base());
  if (ticks == std::numeric_limits<std::int64_t>::min())
    return since < 0 ? -kMost : kMost;  // it does not fit
  return std::clamp(first_pts_ + std::clamp(ticks, -kMost, kMost), -kMost, kMost);
}

std::int64_t VideoEncoder::most_repeats() const {
  return std::max<std::int64_t>(1, std::llround(kLongestGap / av_q2d(time_base())));
}

/// Whether a frame comes at another time than that of the source, both seen from the first frame. What the
/// source's own clock had rounded, such as the milliseconds of Matroska, is none.
bool VideoEncoder::is_moved(std::int64_t pts, std::int64_t time) const {
  constexpr double kTicksOfFrame = 3;  // where ticks are so much finer than frames
  const AVRational from = to_av(info_.time_base), to = time_base();
  const bool rounds =
      info_.frame_rate.known() && kTicksOfFrame * av_q2d(from) * info_.frame_rate.value() <= 1;
  const std::int64_t slack = rounds ? 1 : 0;
  const std::int64_t at = pts - first_pts_, wanted = time - first_time_;
  return av_compare_ts(at, to, wanted - slack, from) < 0 || av_compare_ts(at, to, wanted + slack, from) > 0;
}

/// Of all frames together; rounded as libav rounds the times of a WebP.
std::int64_t VideoEncoder::milliseconds() const {
  const auto at = [&](std::int64_t time) {
    return av_rescale_q_rnd(time, time_base(), AVRational{1, 1000}, AV_ROUND_ZERO);
  };
  return at(last_end_) - at(first_pts_);
}

void VideoEncoder::cut_gap_before(AVFrame& frame, Warnings& warnings) {
  if (!last_) return;
  const std::int64_t excess = frame.pts - last_pts_ - most_repeats();
  if (excess <= 0) return;
  cut_out_ += excess;
  frame.pts -= excess;
  warnings.count("gaps of more than ten minutes are cut short, because they are filled with frames");
}

/// The last frame once more at every tick that has gone by since.
void VideoEncoder::repeat_until(std::int64_t pts, const Receiver& receiver) {
  while (fills_gaps_ && last_ && last_pts_ + 1 < pts) {
    last_->pts = ++last_pts_;
    send(last_.get(), receiver);
  }
}

void VideoEncoder::finish(const Receiver& receiver) {
  repeat_until(last_end_, receiver);
  send(nullptr, receiver);
}

void VideoEncoder::send(AVFrame* frame, const Receiver& receiver) {
  int result = avcodec_send_frame(encoder_.get(), frame);
  const PacketPtr packet = new_packet();
  while (result >= 0) {
    result = avcodec_receive_packet(encoder_.get(), packet.get());
    if (result < 0) break;
    if (clears_) clear_before_next(*packet);
    if (is_webp_) end_webp_at(*packet, milliseconds());
    if (const auto found = durations_.find(packet->pts); found != durations_.end()) {
      packet->duration = found->second;
      durations_.erase(found);
    }
    receiver(*packet);
    av_packet_unref(packet.get());
  }
  if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
  if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
  throw Error(ErrorKind::kInternal,
              std::string("encoder '") + encoder_->codec->name + "' failed: " + error_text(result));
}

}  // namespace knotreel::video
