// SPDX-License-Identifier: GPL-3.0-or-later
#include "stream_description.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "colour_rules.h"
#include "demuxer.h"

namespace knotreel::video {
namespace {

/// Raw streams are cut into packets by a parser, whose times are guesses; rawvideo knows its rate.
bool has_times(const AVInputFormat& format, const AVFrame& first) {
  if ((format.flags & AVFMT_NOTIMESTAMPS) != 0 || reads_pictures(format)) return false;
  const bool raw = format.raw_codec_id != AV_CODEC_ID_NONE && format.raw_codec_id != AV_CODEC_ID_RAWVIDEO;
  return !raw && first.best_effort_timestamp != AV_NOPTS_VALUE;
}

ColourTags colours(const AVFrame& frame, const AVPixFmtDescriptor& description) {
  const auto format = AVPixelFormat(frame.format);
  ColourTags tags;
  tags.range = without_range(format) != format ? int(AVCOL_RANGE_JPEG) : int(frame.color_range);
  tags.matrix = is_rgb(description) ? int(AVCOL_SPC_UNSPECIFIED) : int(frame.colorspace);
  tags.primaries = frame.color_primaries;
  tags.transfer = frame.color_trc;
  tags.chroma_location = frame.chroma_location;
  return tags;
}

Fields fields_of(const AVStream& stream, const AVFrame& first) {
  if (first.interlaced_frame != 0)
    return first.top_field_first != 0 ? Fields::kTopFirst : Fields::kBottomFirst;
  switch (stream.codecpar->field_order) {
    case AV_FIELD_TT:
    case AV_FIELD_BT:
      return Fields::kTopFirst;
    case AV_FIELD_BB:
    case AV_FIELD_TB:
      return Fields::kBottomFirst;
    default:
      return Fields::kNone;
  }
}

void describe_shape(StreamInfo& info, const AVFrame& frame) {
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(AVPixelFormat(frame.format));
  info.width = frame.width;
  info.height = frame.height;
  info.channels = channels_of(description);
  info.depth = depth_of(description);
  info.pixel_format = description.name;
  info.colour = colours(frame, description);
}

void describe_pictures(StreamInfo& info, AVFormatContext& format, AVStream& stream, AVFrame& frame) {
  describe_shape(info, frame);
  info.fields = fields_of(stream, frame);
  info.sample_aspect = from_av(av_guess_sample_aspect_ratio(&format, &stream, &frame));
  std::size_t size = 0;
  const std::uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &size);
  if (matrix == nullptr) return;
  const auto* bytes = reinterpret_cast<const std::byte*>(matrix);
  info.display_matrix.assign(bytes, bytes + size);
}

/// A time that a damaged or made-up file tells may be anything; beyond kMaxTicks it counts as not told.
std::int64_t in_range(double ticks) {
  return std::abs(ticks) <= double(kMaxTicks) ? std::llround(ticks) : 0;
}
std::int64_t in_range(std::int64_t ticks) {
  return is_time(ticks) ? ticks : 0;
}

/// Whether what is told for a rate is how fine the clock is, as by H.264 whose rate varies.
bool is_of_ticks(AVRational rate, AVRational time_base) {
  constexpr AVRational kFine{1, 1000};
  return rate.num > 0 && av_cmp_q(time_base, kFine) < 0 && av_cmp_q(rate, av_inv_q(time_base)) >= 0;
}

/// Time base and rate, which depend on each other where a source has no times.
void describe_times(StreamInfo& info, AVFormatContext& format, AVStream& stream,
                    const AVCodecContext& decoder, const ReadOptions& options) {
  AVRational told{0, 1};
  if (const auto option = options.demuxer_options.find("framerate"); option != options.demuxer_options.end())
    av_parse_video_rate(&told, option->second.c_str());
  AVRational rate = av_guess_frame_rate(&format, &stream, nullptr);
  if (is_of_ticks(rate, stream.time_base)) rate = stream.avg_frame_rate;
  info.frame_rate = is_of_ticks(rate, stream.time_base) ? Rational{} : from_av(rate);
  if (!info.timestamps && decoder.framerate.num > 0) info.frame_rate = from_av(decoder.framerate);
  if (reads_pictures(*format.iformat)) info.frame_rate = options.image_rate;
  if (!info.timestamps && told.num > 0) info.frame_rate = from_av(told);
  info.time_base = from_av(stream.time_base);
  if (!info.timestamps) {
    if (!info.frame_rate.known()) info.frame_rate = {25, 1};
    info.time_base = {info.frame_rate.den, info.frame_rate.num};
  }
  const bool clock = (format.iformat->flags & AVFMT_TS_DISCONT) != 0 && info.timestamps;
  if (clock && format.start_time != AV_NOPTS_VALUE) {
    info.start = in_range(av_rescale_q(format.start_time, AVRational{1, AV_TIME_BASE}, stream.time_base));
  }
}

void estimate_length(StreamInfo& info, const AVFormatContext& format, const AVStream& stream) {
  if (stream.duration > 0) {
    info.seconds = double(stream.duration) * av_q2d(stream.time_base);
  } else if (format.duration > 0) {
    info.seconds = double(format.duration) / AV_TIME_BASE;
  }
  info.frames = stream.nb_frames > 0 ? std::uint64_t(stream.nb_frames)
                                     : std::uint64_t(in_range(info.seconds * info.frame_rate.value()));
  const bool seekable = format.pb != nullptr && (format.pb->seekable & AVIO_SEEKABLE_NORMAL) != 0;
  info.end = in_range(told_end(format, stream) / info.time_base.value());
  info.still = reads_pictures(*format.iformat) && stream.nb_frames <= 1 && seekable;
  if (info.still) info.frames = 1;
}

/// "00:01:02.345000000", as Matroska tells lengths in its tags; 0 if it is anything else. With a point
/// whatever the locale of the program.
double seconds_of(std::string_view text) {
  double seconds = 0;
  for (int part = 0; part < 3; ++part) {
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc()) return 0;
    text.remove_prefix(std::size_t(end - text.data()));
    const bool separated = part == 2 ? text.empty() : text.starts_with(':');
    if (!separated || !(value >= 0)) return 0;
    if (part < 2) text.remove_prefix(1);
    seconds = 60 * seconds + value;
  }
  return seconds;
}

}  // namespace

StreamInfo describe_stream(AVFormatContext& format, AVStream& stream, const AVCodecContext& decoder,
                           AVFrame& first, const ReadOptions& options) {
  StreamInfo info;
  info.codec = avcodec_get_name(decoder.codec_id);
  info.container = format.iformat->name;
  info.timestamps = has_times(*format.iformat, first);
  describe_pictures(info, format, stream, first);
  describe_times(info, format, stream, decoder, options);
  estimate_length(info, format, stream);
  return info;
}

void describe_filtered(StreamInfo& info, const AVFrame& first, AVRational time_base, AVRational rate) {
  describe_shape(info, first);
  info.sample_aspect = from_av(first.sample_aspect_ratio);
  info.start = in_range(av_rescale_q(info.start, to_av(info.time_base), time_base));
  info.time_base = from_av(time_base);
  if (rate.num > 0 && rate.den > 0) info.frame_rate = from_av(rate);
  // What the container tells is of other frames.
  info.frames = std::uint64_t(in_range(info.seconds * info.frame_rate.value()));
  info.end = 0;
}

double told_end(const AVFormatContext& format, const AVStream& stream) {
  constexpr double kRounding = 0.01;  // seconds
  if (stream.duration > 0 && stream.start_time != AV_NOPTS_VALUE) {
    return (double(stream.start_time) + double(stream.duration)) * av_q2d(stream.time_base);
  }
  const AVDictionaryEntry* entry = av_dict_get(stream.metadata, "DURATION", nullptr, 0);
  const double end = entry == nullptr ? 0 : seconds_of(entry->value);
  if (format.duration <= 0) return end;
  // A tag from before the file was cut by a tool that knows nothing of it tells of more than there is.
  const double length = double(format.duration) / AV_TIME_BASE;
  const double begin = format.start_time == AV_NOPTS_VALUE ? 0 : double(format.start_time) / AV_TIME_BASE;
  return end <= begin + length + kRounding ? end : 0;
}

Rational sample_aspect_at(const StreamInfo& stream, int width, int height) {
  const Rational& aspect = stream.sample_aspect;
  const std::int64_t wide = std::int64_t{stream.width} * height, high = std::int64_t{stream.height} * width;
  const bool same_shape = std::abs(wide - high) <= std::max(stream.width, stream.height);
  if (!aspect.known() || aspect.num == aspect.den || same_shape) return aspect;
  AVRational stretch{};
  av_reduce(&stretch.num, &stretch.den, wide, high, std::numeric_limits<int>::max());
  return from_av(av_mul_q(to_av(aspect), stretch));
}

ColourNames names_of(const ColourTags& tags) {
  const auto name = [](bool told, const char* text) { return std::string(told && text ? text : ""); };
  return {name(tags.range != AVCOL_RANGE_UNSPECIFIED, av_color_range_name(AVColorRange(tags.range))),
          name(tags.matrix != AVCOL_SPC_UNSPECIFIED, av_color_space_name(AVColorSpace(tags.matrix))),
          name(tags.primaries != AVCOL_PRI_UNSPECIFIED,
               av_color_primaries_name(AVColorPrimaries(tags.primaries))),
          name(tags.transfer != AVCOL_TRC_UNSPECIFIED,
               av_color_transfer_name(AVColorTransferCharacteristic(tags.transfer))),
          name(tags.chroma_location != AVCHROMA_LOC_UNSPECIFIED,
               av_chroma_location_name(AVChromaLocation(tags.chroma_location)))};
}

namespace {

using DisplayMatrix = std::array<std::int32_t, 9>;

std::optional<DisplayMatrix> display_matrix(const StreamInfo& info) {
  DisplayMatrix matrix{};
  if (info.display_matrix.size() != sizeof matrix) return {};
  std::memcpy(matrix.data(), info.display_matrix.data(), sizeof matrix);
  return matrix;
}

}  // namespace

bool is_mirrored(const StreamInfo& info) {
  const auto matrix = display_matrix(info);
  if (!matrix) return false;
  const auto& [right_x, right_y, u, down_x, down_y, v, x, y, w] = *matrix;
  return double(right_x) * double(down_y) < double(right_y) * double(down_x);
}

double rotation_degrees(const StreamInfo& info) {
  const auto matrix = display_matrix(info);
  if (!matrix) return 0;
  const double anticlockwise = av_display_rotation_get(matrix->data());
  if (!std::isfinite(anticlockwise)) return 0;
  // That of a step to the right, which leads to the left where it is mirrored.
  double clockwise = -anticlockwise;
  if (is_mirrored(info)) clockwise += clockwise > 0 ? -180 : 180;
  return clockwise != 0 ? clockwise : 0;  // not -0
}

std::vector<StreamEntry> list_streams(const AVFormatContext& format) {
  std::vector<StreamEntry> all;
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    const AVStream& stream = *format.streams[i];
    const char* kind = av_get_media_type_string(stream.codecpar->codec_type);
    const AVDictionaryEntry* language = av_dict_get(stream.metadata, "language", nullptr, 0);
    all.push_back({int(i), kind == nullptr ? "unknown" : kind, avcodec_get_name(stream.codecpar->codec_id),
                   language == nullptr ? "" : language->value});
  }
  return all;
}

}  // namespace knotreel::video
