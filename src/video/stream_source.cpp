// SPDX-License-Identifier: GPL-3.0-or-later
#include "stream_source.h"

#include <algorithm>
#include <istream>
#include <memory>
#include <string_view>

#include "gif_alpha.h"
#include "knotreel/base/error.h"
#include "stream_description.h"

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

/// MP4 files have their index at their end if nothing else is asked for.
std::string hint_of_pipe(const AVFormatContext& format) {
  const bool from_pipe = format.pb && (format.pb->seekable & AVIO_SEEKABLE_NORMAL) == 0;
  const bool has_index = std::string_view(format.iformat->name).find("mp4") != std::string_view::npos;
  return from_pipe && has_index ? "; from a pipe, MP4 must have its index at its beginning (faststart)" : "";
}

/// GIFs are decoded with alpha, which most of them have no use for.
void drop_idle_alpha(StreamInfo& info, const AVFrame& first, const Demuxer& demuxer) {
  if (info.codec != "gif" || first.format != AV_PIX_FMT_BGRA || !is_opaque(first)) return;
  const std::unique_ptr<std::istream> again = demuxer.from_its_start();
  if (!again || !stays_opaque(*again)) return;
  info.channels = 3;
  info.pixel_format = av_get_pix_fmt_name(AV_PIX_FMT_BGR0);
}

/// How long a frame lasts by itself; 0 if nothing tells.
std::int64_t duration_of(const AVFrame& frame, const StreamInfo& info) {
  if (frame.pkt_duration > 0 && is_time(frame.pkt_duration)) return frame.pkt_duration;
  if (!info.frame_rate.known()) return 0;
  const std::int64_t usual = av_rescale_q(1, av_inv_q(to_av(info.frame_rate)), to_av(info.time_base));
  return is_time(usual) ? usual : 0;
}

}  // namespace

StreamSource::StreamSource(const std::string& input, const ReadOptions& options)
    : demuxer_(input, options), strict_(options.strict), chapters_(options.chapters) {
  open_decoder(options.threads);
  if (const int others = demuxer_.other_videos(); others > 0) {
    warnings_.add(std::to_string(others) + " more video streams are left out");
  }
  if (options.copy_streams && demuxer_.covers() > 0) warnings_.add("cover pictures are left out");
  begin(options);
  if (std::uint64_t(info_.width) * std::uint64_t(info_.height) > image::kMaxPixels) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "its frames have too many pixels");
  }
  to_image_.emplace(info_.width, info_.height, info_.channels);
}

/// The first frame tells what the others are like.
void StreamSource::begin(const ReadOptions& options) {
  FramePtr first = decode();
  if (!first)
    throw Error(ErrorKind::kInput,
                demuxer_.cannot_read() + "no frame of it can be decoded" + hint_of_pipe(*demuxer_.format()));
  decoded_info_ = describe_stream(*demuxer_.format(), *demuxer_.video(), *decoder_, *first, options);
  drop_idle_alpha(decoded_info_, *first, demuxer_);
  stamp(*first);
  filter_.emplace(options, decoded_info_, warnings_);
  filter_->send(std::move(first));
  ahead_ = filtered();
  if (!ahead_) throw Error(ErrorKind::kInvalidArgument, "no frame is left by '" + options.filter + "'");
  info_ = decoded_info_;
  if (filter_->changes_times())
    describe_filtered(info_, *ahead_, filter_->time_base(), filter_->frame_rate());
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
  decoder_->err_recognition |= AV_EF_CRCCHECK;
  if (strict_) decoder_->err_recognition |= AV_EF_EXPLODE | AV_EF_CAREFUL;
  // This one mends slices with a wrong checksum and tells of it nowhere but in the log.
  if (codec->id == AV_CODEC_ID_FFV1) decoder_->opaque = &complaints_;
  const int result = avcodec_open2(decoder_.get(), codec, nullptr);
  if (result < 0) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "decoder '" + name + "': " + error_text(result));
  }
}

std::vector<int> StreamSource::copied_streams() const {
  std::vector<int> streams;
  for (unsigned i = 0; i < format()->nb_streams; ++i) {
    if (demuxer_.copied(int(i))) streams.push_back(int(i));
  }
  return streams;
}

void StreamSource::damage(const std::string& why, const std::string& told) {
  ++damaged_;
  if (strict_) {
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "damaged after frame " +
                                       std::to_string(decoded_) + " (" + why + ")");
  }
  warnings_.count(told);
}

/// The next frame as it is handed out; null at the end.
FramePtr StreamSource::filtered() {
  for (;;) {
    if (FramePtr frame = filter_->receive()) return frame;
    if (filter_ended_) return {};
    FramePtr frame = decode();
    if (frame) {
      stamp(*frame);
    } else {
      filter_ended_ = true;
    }
    filter_->send(std::move(frame));
  }
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
      const bool complained = complaints_.exchange(0) > 0;
      if (frame->best_effort_timestamp < shown_from_) return frame;
      if (complained || frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
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

/// Null at the end.
PacketPtr StreamSource::read_packet() {
  std::string why;
  const std::size_t joints = demuxer_.joints();
  PacketPtr packet = demuxer_.read(why);
  if (demuxer_.joints() > joints)
    warnings_.count(
        "joints, where the clock of the input starts anew: what follows is put behind what was before");
  if (!why.empty()) {
    if (strict_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + why);
    warnings_.add("the input ends early: " + why);
    cut_short_ = true;
  }
  return packet;
}

void StreamSource::feed() {
  PacketPtr packet = read_packet();
  if (!packet) {
    if (gap_) take_gap();
    avcodec_send_packet(decoder_.get(), nullptr);
  } else if (packet->stream_index == demuxer_.video_index()) {
    take_video(std::move(packet));
  } else {
    keep(std::move(packet));
  }
}

void StreamSource::keep(PacketPtr packet) {
  const AVRational time_base = demuxer_.format()->streams[packet->stream_index]->time_base;
  packets_.emplace_back(std::make_shared<const CopiedPacket>(CopiedPacket{std::move(packet), time_base}));
}

std::vector<Packet> StreamSource::packets_until(double seconds) {
  if (copied_streams().empty()) return {};
  while (clock_ <= seconds && !packets_ended_) {
    PacketPtr packet = read_packet();
    if (!packet) {
      packets_ended_ = true;
      check_end();
      break;
    }
    const AVRational unit = demuxer_.format()->streams[packet->stream_index]->time_base;
    if (packet->dts != AV_NOPTS_VALUE) clock_ = double(packet->dts) * av_q2d(unit);
    if (packet->stream_index == demuxer_.video_index()) {
      pass_over(*packet);
    } else {
      keep(std::move(packet));
    }
  }
  return take_packets();
}

/// A packet of the video that is not decoded: only how far the video goes is of interest.
void StreamSource::pass_over(const AVPacket& packet) {
  if (packet.pts == AV_NOPTS_VALUE || packet.pts < last_pts_) return;
  last_pts_ = packet.pts;
  if (packet.duration > 0) last_duration_ = packet.duration;
}

/// Tells of the last gap unless it was a joint, from which on packets are numbered anew.
void StreamSource::take_gap() {
  const bool was_joint = demuxer_.joints_before_video() > gap_->joints;
  gap_.reset();
  if (!was_joint) damage("packets are missing", "gaps in the video; frames show what is there");
}

/// The demuxer tells of a gap with the packet before the one that lacks something, which is thus whole, and
/// of a joint behind it. What is there of a frame is better than a gap.
void StreamSource::look_for_gap(const AVPacket& packet) {
  constexpr int kPacketsUntilJoint = 2;
  const bool is_told = (packet.flags & AV_PKT_FLAG_CORRUPT) != 0;
  if (gap_ && (is_told || ++gap_->packets == kPacketsUntilJoint)) take_gap();
  if (is_told) gap_ = Gap{demuxer_.joints_before_video()};
}

void StreamSource::take_video(PacketPtr packet) {
  if (demuxer_.numbers_packets()) {
    look_for_gap(*packet);
  } else if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0) {
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
  std::int64_t pts = is_time(frame.best_effort_timestamp) ? frame.best_effort_timestamp : AV_NOPTS_VALUE;
  if (!decoded_info_.timestamps) {
    pts = last_pts_ == AV_NOPTS_VALUE ? 0 : last_pts_ + 1;
    frame.pkt_duration = 1;
  } else if (pts == AV_NOPTS_VALUE) {
    pts = last_pts_ == AV_NOPTS_VALUE ? 0 : last_pts_ + step;
    warnings_.count("frames have no time; it is made from the frame before");
  } else if (last_pts_ != AV_NOPTS_VALUE && pts <= last_pts_) {
    pts = last_pts_ + step;
    warnings_.count("frames go back in time; they are put after the frame before");
  }
  if (!is_time(pts))
    throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "the times of frames are out of range");
  frame.pts = pts;
  last_pts_ = pts;
  last_duration_ = duration_of(frame, decoded_info_);
}

/// Nothing is missing, for certain.
bool StreamSource::is_whole() const {
  return !cut_short_ && demuxer_.end() == FileEnd::kThere;
}

/// What stands beside the last frame may be nothing (Matroska), or the time until the next frame to be
/// decoded (mp4); the end of the track tells better. Far away it is that of a last frame which is long, or of
/// others that are not there.
std::int64_t StreamSource::last_duration(const AVFrame& frame) const {
  const std::int64_t usual = duration_of(frame, info_);
  const std::int64_t told = info_.end - frame.pts;
  if (info_.end <= 0 || told <= usual / 4) return usual;
  return told < usual * 4 || is_whole() ? told : usual;
}

/// What is not there of what the input tells of its own length; empty if nothing is missed.
std::string StreamSource::what_is_missing() const {
  const FileEnd end = demuxer_.end();
  if (end == FileEnd::kThere) return "";
  const bool guessed = demuxer_.format()->duration_estimation_method == AVFMT_DURATION_FROM_BITRATE;
  if (decoded_info_.timestamps && !guessed) {
    const double tick = decoded_info_.time_base.value();
    const double missing =
        told_end(*demuxer_.format(), *demuxer_.video()) - (double(last_pts_) + double(last_duration_)) * tick;
    if (missing >= std::max(0.2, 3 * double(last_duration_) * tick))
      return "it tells of " + std::to_string(missing) + " s more";
  }
  return end == FileEnd::kMissing ? "the end of the file is missing" : "";
}

void StreamSource::check_end() {
  if (cut_short_) return;
  const std::string why = what_is_missing();
  if (why.empty()) return;
  if (strict_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + why);
  warnings_.add("the input ends early: " + why);
}

void StreamSource::look_ahead() {
  ahead_ = filtered();
  if (ahead_) {
    look_at(*ahead_);
  } else {
    check_end();
  }
}

void StreamSource::look_at(AVFrame& frame) {
  if (frame.width != info_.width || frame.height != info_.height) {
    warnings_.count("frames are of another size than the first, and scaled to it");
  }
}

/// Fills in all but the picture, which is in what is returned; null at the end.
FramePtr StreamSource::advance(Frame& frame) {
  if (!ahead_) return nullptr;
  FramePtr current = std::move(ahead_);
  look_ahead();
  frame.index = handed_out_++;
  frame.pts = current->pts;
  frame.duration = ahead_ ? ahead_->pts - current->pts : last_duration(*current);
  frame.packets = take_packets();
  return current;
}

bool StreamSource::next(Frame& frame) {
  const FramePtr current = advance(frame);
  if (!current) return false;
  frame.image = to_image_->convert(*current);
  return true;
}

bool StreamSource::skip(Frame& frame) {
  return advance(frame) != nullptr;
}

/// Goes on with the last frame before a time that can be decoded at once. @return whether there is one.
bool StreamSource::decode_from(std::int64_t pts) {
  if (!demuxer_.seek(pts)) return false;
  avcodec_flush_buffers(decoder_.get());
  complaints_ = 0;
  drained_ = false;
  packets_.clear();
  last_pts_ = AV_NOPTS_VALUE;
  last_duration_ = 0;
  filter_->reset();
  filter_ended_ = false;
  ahead_ = filtered();
  if (ahead_) look_at(*ahead_);
  return ahead_ != nullptr;
}

/// A few seconds earlier: sound may lie a little away from the frames it belongs to, and the first frames
/// behind the packet that is found may need some before it.
bool StreamSource::seek(double seconds) {
  constexpr double kEarlier = 3;
  if (!ahead_ || !info_.timestamps || strict_ || filter_->changes_times()) return false;
  const double target = (seconds - kEarlier) / info_.time_base.value();
  const std::int64_t here = ahead_->pts;
  if (!(target > double(here)) || target > double(kMaxTicks)) return false;
  shown_from_ = std::int64_t(target);
  if (decode_from(shown_from_) && double(ahead_->pts) <= target) return true;
  shown_from_ = AV_NOPTS_VALUE;
  if (ahead_ && ahead_->pts == here) return false;
  // The index is wrong. Back to where this began.
  bool is_back = decode_from(here);
  while (is_back && ahead_ && ahead_->pts < here) look_ahead();
  if (!is_back || !ahead_) throw Error(ErrorKind::kInput, demuxer_.cannot_read() + "its index is damaged");
  return false;
}

std::unique_ptr<Source> open_stream(const std::string& input, const ReadOptions& options) {
  return std::make_unique<StreamSource>(input, options);
}

}  // namespace knotreel::video
