// SPDX-License-Identifier: GPL-3.0-or-later
#include "encoder_choice.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <vector>

#include "colour_rules.h"
#include "knotreel/base/error.h"

namespace knotreel::video {
namespace {

/// Encoders that are known to do well, and the quality that looks like the source at a sane size.
struct Known {
  const char* codec;
  const char* encoder;
  double crf;
};
constexpr std::array kKnown = {Known{"h264", "libx264", 18},    Known{"hevc", "libx265", 20},
                               Known{"vp9", "libvpx-vp9", 24},  Known{"vp8", "libvpx", 8},
                               Known{"av1", "libaom-av1", 24},  Known{"ffv1", "ffv1", -1},
                               Known{"prores", "prores_ks", -1}};

std::string names_of_encoders() {
  std::string names;
  for (const Known& known : kKnown) {
    if (avcodec_find_encoder_by_name(known.encoder) == nullptr) continue;
    names += (names.empty() ? "" : ", ") + std::string(known.codec);
  }
  return names;
}

const AVCodec* by_name(const std::string& codec) {
  for (const Known& known : kKnown) {
    if (codec == known.codec || codec == known.encoder) return avcodec_find_encoder_by_name(known.encoder);
  }
  if (const AVCodec* encoder = avcodec_find_encoder_by_name(codec.c_str())) return encoder;
  const AVCodecDescriptor* description = avcodec_descriptor_get_by_name(codec.c_str());
  return description == nullptr ? nullptr : avcodec_find_encoder(description->id);
}

const AVCodec* default_of(const AVOutputFormat& container) {
  const std::string name = container.name;
  if (name == "matroska" || name == "mp4" || name == "mov" || name == "nut" || name == "mpegts" ||
      name == "flv" || name == "m4v" || name == "3gp" || name == "3g2") {
    return by_name("h264");
  }
  if (name == "webm") return by_name("vp9");
  return avcodec_find_encoder(container.video_codec);
}

/// Half of the time of x264's own default, at the same size and nearly the same quality for what is drawn
/// from vectors (docs/decisions/0013-libav.md).
constexpr const char* kX264Preset = "faster";

/// Pixels. libav decodes slices of FFV1 that are a row high a row too low, and refuses some that are a column
/// wide; pictures of a row or a column come back black.
constexpr int kSmallForSlices = 16;

constexpr double kScale = 2;  ///< of set_scale(), if nothing is said: as good as it gets but for the size
/// Theora's own scale goes up to the best; ours is what is missing to it.
constexpr double kMostTheoraQuality = 10;
/// So does WebP's.
constexpr double kMostWebpQuality = 100, kWebpCrf = 10;
constexpr double kWorstX264 = 51;  ///< and of x265; libav sets no limit, and x264 takes more for it unsaid
constexpr double kWorstScale = 31;
constexpr double kFinestVp8 = 4;  ///< unless its encoder is told that it may go below

/// Encoders of libav with a scale of quantisers, from 1 to 31; without one they would go for 200 kbit/s.
bool is_scaled(const std::string& encoder) {
  static constexpr std::array kScaled = {"mpeg1video", "mpeg2video", "mpeg4", "mjpeg", "amv",  "msmpeg4",
                                         "msmpeg4v2",  "wmv1",       "wmv2",  "flv",   "h261", "h263",
                                         "h263p",      "rv10",       "rv20",  "snow",  "svq1", "libxvid"};
  return std::find(kScaled.begin(), kScaled.end(), encoder) != kScaled.end();
}

void set_scale(AVCodecContext& encoder, double value) {
  encoder.flags |= AV_CODEC_FLAG_QSCALE;
  encoder.global_quality = static_cast<int>(value * FF_QP2LAMBDA);
}

bool lossless_rgb(const AVCodec& encoder) {
  return encoder.id == AV_CODEC_ID_FFV1 || encoder.id == AV_CODEC_ID_RAWVIDEO;
}

/// A format to be near to, for sources whose format is not told.
AVPixelFormat likely_source(const AVCodec& encoder, const StreamInfo& frames) {
  const bool deep = frames.depth > 8, alpha = frames.channels % 2 == 0;
  if (frames.channels == 1) return deep ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8;
  if (frames.channels == 2) return deep ? AV_PIX_FMT_YA16 : AV_PIX_FMT_YA8;
  if (lossless_rgb(encoder)) {
    if (alpha) return deep ? AV_PIX_FMT_RGBA64 : AV_PIX_FMT_RGBA;
    return deep ? AV_PIX_FMT_RGB48 : AV_PIX_FMT_RGB24;
  }
  if (alpha) return deep ? AV_PIX_FMT_YUVA420P10 : AV_PIX_FMT_YUVA420P;
  return deep ? AV_PIX_FMT_YUV420P10 : AV_PIX_FMT_YUV420P;
}

bool can_be_packed(AVPixelFormat format) {
  // Its description has two bits of red and three of blue; encoders, and all other code of libav, the
  // reverse.
  if (format == AV_PIX_FMT_RGB8) return false;
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
  constexpr int kNever = AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BAYER |
                         AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BITSTREAM;
  return (description.flags & kNever) == 0 && description.comp[0].depth <= 16 &&
         (is_rgb(description) || is_grey(description) || description.comp[0].depth >= 8);
}

/// What is most like a format with alpha, but has none.
AVPixelFormat without_alpha(AVPixelFormat format) {
  const int channels = channels_of(*av_pix_fmt_desc_get(format)) - 1;
  std::vector<AVPixelFormat> all;
  for (const AVPixFmtDescriptor* d = av_pix_fmt_desc_next(nullptr); d != nullptr;
       d = av_pix_fmt_desc_next(d)) {
    const AVPixelFormat other = av_pix_fmt_desc_get_id(d);
    if (can_be_packed(other) && channels_of(*d) == channels && without_range(other) == other)
      all.push_back(other);
  }
  all.push_back(AV_PIX_FMT_NONE);
  int loss = 0;
  return avcodec_find_best_pix_fmt_of_list(all.data(), format, 0, &loss);
}

AVPixelFormat source_format(const AVCodec& encoder, const StreamInfo& frames) {
  const AVPixelFormat named = av_get_pix_fmt(frames.pixel_format.c_str());
  if (named == AV_PIX_FMT_NONE) return likely_source(encoder, frames);
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(named);
  // Palettes are resolved, and a picture with other channels than its name says has been made over.
  if (named == AV_PIX_FMT_PAL8) return frames.channels == 4 ? AV_PIX_FMT_BGRA : AV_PIX_FMT_RGB24;
  if (has_alpha(description) && channels_of(description) == frames.channels + 1 && can_be_packed(named))
    return without_alpha(named);
  if (channels_of(description) != frames.channels) return likely_source(encoder, frames);
  return can_be_packed(named) ? without_range(named) : likely_source(encoder, frames);
}

/// Formats of containers without an encoder's own list.
std::vector<AVPixelFormat> y4m_formats() {
  return {AV_PIX_FMT_YUV420P,   AV_PIX_FMT_YUV422P,   AV_PIX_FMT_YUV444P,   AV_PIX_FMT_YUV411P,
          AV_PIX_FMT_GRAY8,     AV_PIX_FMT_GRAY10,    AV_PIX_FMT_GRAY12,    AV_PIX_FMT_GRAY16,
          AV_PIX_FMT_YUV420P10, AV_PIX_FMT_YUV422P10, AV_PIX_FMT_YUV444P10, AV_PIX_FMT_YUV420P12,
          AV_PIX_FMT_YUV422P12, AV_PIX_FMT_YUV444P12, AV_PIX_FMT_YUV420P16, AV_PIX_FMT_YUV422P16,
          AV_PIX_FMT_YUV444P16};
}

bool fits_size(const AVCodec& encoder, AVPixelFormat format, const StreamInfo& frames) {
  const std::string name = encoder.name;
  if (encoder.id == AV_CODEC_ID_FFV1 && std::min(frames.width, frames.height) < 2) return false;
  if (name != "libx264" && name != "libx265" && name != "prores_ks") return true;
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
  if (is_rgb(description) || is_grey(description)) return true;
  return frames.width % (1 << description.log2_chroma_w) == 0 &&
         frames.height % (1 << description.log2_chroma_h) == 0;
}

std::vector<AVPixelFormat> candidates(const AVCodec& encoder, const StreamInfo& frames) {
  std::vector<AVPixelFormat> all;
  if (encoder.id == AV_CODEC_ID_GIF) return {AV_PIX_FMT_PAL8, AV_PIX_FMT_GRAY8};
  if (encoder.id == AV_CODEC_ID_WRAPPED_AVFRAME) {
    all = y4m_formats();
  } else if (encoder.pix_fmts == nullptr) {
    all = {source_format(encoder, frames)};
  } else {
    for (const AVPixelFormat* p = encoder.pix_fmts; *p != AV_PIX_FMT_NONE; ++p) all.push_back(*p);
  }
  // Their grey comes out of decoders as luma with neutral chroma, and then has another range.
  const bool no_grey =
      encoder.id == AV_CODEC_ID_H264 || encoder.id == AV_CODEC_ID_HEVC || encoder.id == AV_CODEC_ID_AV1;
  std::erase_if(all, [&](AVPixelFormat format) {
    if (no_grey && is_grey(*av_pix_fmt_desc_get(format))) return true;
    // Ranges are told beside the format, except to encoders that know no other way.
    const bool twin = std::find(all.begin(), all.end(), without_range(format)) != all.end();
    return !can_be_packed(format) || !fits_size(encoder, format, frames) ||
           (without_range(format) != format && twin);
  });
  return all;
}

/// Grey, where there is none, is 4:2:0, since chroma of any size holds nothing.
AVPixelFormat nearest_aim(AVPixelFormat source, const std::vector<AVPixelFormat>& all) {
  const auto grey = [](AVPixelFormat format) { return is_grey(*av_pix_fmt_desc_get(format)); };
  if (!grey(source) || std::any_of(all.begin(), all.end(), grey)) return source;
  const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(source);
  const bool deep = depth_of(format) > 8;
  if (has_alpha(format)) return deep ? AV_PIX_FMT_YUVA420P10 : AV_PIX_FMT_YUVA420P;
  return deep ? AV_PIX_FMT_YUV420P10 : AV_PIX_FMT_YUV420P;
}

AVPixelFormat named_format(const AVCodec& encoder, const StreamInfo& frames,
                           const std::vector<AVPixelFormat>& all, const std::string& wanted) {
  const AVPixelFormat format = av_get_pix_fmt(wanted.c_str());
  if (format == AV_PIX_FMT_NONE) {
    throw Error(ErrorKind::kInvalidArgument, "no pixel format is called '" + wanted + "'");
  }
  const bool any = encoder.pix_fmts == nullptr && encoder.id != AV_CODEC_ID_WRAPPED_AVFRAME;
  if (any && can_be_packed(format)) return format;
  if (std::find(all.begin(), all.end(), format) != all.end()) return format;
  std::string names;
  for (const AVPixelFormat p : all)
    names += (names.empty() ? "" : ", ") + std::string(av_get_pix_fmt_name(p));
  throw Error(ErrorKind::kInvalidArgument, std::string("encoder '") + encoder.name +
                                               "' has no pixel format '" + wanted + "' at " +
                                               std::to_string(frames.width) + "x" +
                                               std::to_string(frames.height) + "; there are " + names);
}

/// In the form of the C locale, whatever the program that uses this has set.
std::string number_text(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

/// Where the scale of WriteOptions::crf ends for an encoder; none: it has no such scale.
std::optional<double> worst_quality(const AVCodec& encoder) {
  const std::string name = encoder.name;
  if (name == "libtheora") return kMostTheoraQuality;
  if (name == "libwebp" || name == "libwebp_anim") return kMostWebpQuality;
  if (is_scaled(name)) return kWorstScale;
  const AVClass* options = encoder.priv_class;
  if (options == nullptr) return std::nullopt;
  const AVOption* crf = av_opt_find(&options, "crf", nullptr, 0, AV_OPT_SEARCH_FAKE_OBJ);
  if (crf == nullptr) return std::nullopt;
  return name.starts_with("libx26") ? kWorstX264 : crf->max;
}

/// @throws Error{kInvalidArgument} for a quality beyond the encoder's scale, or one that is no number.
void check_quality(const AVCodec& encoder, double crf) {
  if (crf < 0) return;
  const std::optional<double> worst = worst_quality(encoder);
  if (!worst || crf <= *worst) return;
  throw Error(ErrorKind::kInvalidArgument, std::string("encoder '") + encoder.name +
                                               "' takes a crf from 0 to " + number_text(*worst) + ", not " +
                                               number_text(crf));
}

/// @param crf  below 0: the default.
void set_constant_quality(AVCodecContext& encoder, Options& dictionary, double crf) {
  const std::string name = encoder.codec->name;
  for (const Known& known : kKnown) {
    if (name == known.encoder && crf < 0) crf = known.crf;
  }
  if (name == "libtheora") {
    set_scale(encoder, kMostTheoraQuality - (crf < 0 ? kScale : crf));
  } else if (name == "libwebp" || name == "libwebp_anim") {
    dictionary.set("quality", number_text(kMostWebpQuality - (crf < 0 ? kWebpCrf : crf)));
  } else if (is_scaled(name)) {
    set_scale(encoder, crf < 0 ? kScale : crf);
  } else if (crf >= 0) {
    dictionary.set("crf", number_text(crf));
  }
  // Constant quality, not a rate, is what these two do only at a rate of zero.
  if (name == "libvpx-vp9" || name == "libaom-av1") encoder.bit_rate = 0;
  if (name == "libvpx") {
    encoder.bit_rate = 100'000'000;
    if (crf < kFinestVp8) encoder.qmin = 0;
  }
}

/// Whether the user asks for bits per second or a quantiser.
bool has_rate(const WriteOptions& options) {
  return options.encoder_options.contains("b") || options.encoder_options.contains("qp");
}

/// x264 prints before it refuses such a name, so it is not asked.
/// @throws Error{kInvalidArgument} naming what there is.
void require_known(const std::string& what, const std::string& name, std::span<const char* const> known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  std::string all;
  for (const char* k : known) all += (all.empty() ? "" : ", ") + std::string(k);
  throw Error(ErrorKind::kInvalidArgument, "no " + what + " is called '" + name + "'; there are " + all);
}

void set_named_preset(const AVCodec& encoder, Options& dictionary, const std::string& preset) {
  static constexpr std::array kPresets = {"ultrafast", "superfast", "veryfast", "faster",   "fast",
                                          "medium",    "slow",      "slower",   "veryslow", "placebo"};
  const std::string name = encoder.name;
  if (name != "libx264" && name != "libx265") {
    throw Error(ErrorKind::kInvalidArgument, "encoder '" + name + "' has no presets");
  }
  require_known("preset", preset, kPresets);
  dictionary.set("preset", preset);
}

void add_to_list(Options& dictionary, const std::string& key, const std::string& value) {
  const std::string before = dictionary.value(key);
  dictionary.set(key, before.empty() ? value : before + ":" + value);
}

/// Sums of x264's lookahead read memory that was never written, if they use AVX-512: another stream each
/// time.
void keep_repeatable(Options& dictionary) {
  if ((av_get_cpu_flags() & AV_CPU_FLAG_AVX512) == 0) return;
  add_to_list(dictionary, "x264-params", "asm=sse2fast,lzcnt,avx2,bmi2,fma3");
}

/// @throws Error{kInvalidArgument} for a tuning or profile that x264 does not have.
void check_x264_names(const std::map<std::string, std::string>& options) {
  static constexpr std::array kTunes = {"film", "animation", "grain",      "stillimage",
                                        "psnr", "ssim",      "fastdecode", "zerolatency"};
  static constexpr std::array kProfiles = {"baseline", "main", "high", "high10", "high422", "high444"};
  if (const auto tune = options.find("tune"); tune != options.end()) {
    std::istringstream names(tune->second);  // some go together
    for (std::string name; std::getline(names, name, ',');) require_known("tune", name, kTunes);
  }
  if (const auto profile = options.find("profile"); profile != options.end())
    require_known("profile", profile->second, kProfiles);
}

/// What the user says, over what has been chosen; lists of an encoder's own options go on with the user's.
void set_options(const AVCodec& encoder, Options& dictionary,
                 const std::map<std::string, std::string>& options) {
  const std::string name = encoder.name;
  if (name == "libx264") check_x264_names(options);
  for (const auto& [key, value] : options) {
    if (key == "preset" && (name == "libx264" || name == "libx265")) {
      set_named_preset(encoder, dictionary, value);
      continue;
    }
    if (key == "x264-params" || key == "x265-params") {
      add_to_list(dictionary, key, value);
    } else {
      dictionary.set(key, value);
    }
  }
}

}  // namespace

const AVCodec* choose_encoder(const std::string& codec, const AVOutputFormat& container) {
  const AVCodec* encoder = codec.empty() ? default_of(container) : by_name(codec);
  if (encoder != nullptr && encoder->type == AVMEDIA_TYPE_VIDEO) return encoder;
  const std::string what = codec.empty()
                               ? std::string("container '") + container.name + "' has no video encoder"
                               : "no encoder for '" + codec + "'";
  throw Error(ErrorKind::kInvalidArgument, what + "; there are " + names_of_encoders());
}

AVPixelFormat choose_pixel_format(const AVCodec& encoder, const StreamInfo& frames,
                                  const std::string& wanted) {
  std::vector<AVPixelFormat> all = candidates(encoder, frames);
  if (!wanted.empty()) return named_format(encoder, frames, all, wanted);
  if (all.empty()) {
    throw Error(ErrorKind::kInvalidArgument, std::string("encoder '") + encoder.name + "' cannot encode " +
                                                 std::to_string(frames.width) + "x" +
                                                 std::to_string(frames.height));
  }
  if (encoder.id == AV_CODEC_ID_GIF) return frames.channels == 1 ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_PAL8;
  const AVPixelFormat source = nearest_aim(source_format(encoder, frames), all);
  all.push_back(AV_PIX_FMT_NONE);
  int loss = 0;
  return avcodec_find_best_pix_fmt_of_list(all.data(), source, frames.channels % 2 == 0, &loss);
}

void set_quality(AVCodecContext& encoder, Options& dictionary, const WriteOptions& options) {
  const std::string name = encoder.codec->name;
  check_quality(*encoder.codec, options.crf);
  encoder.thread_count = options.threads;
  if (options.crf >= 0 || !has_rate(options)) set_constant_quality(encoder, dictionary, options.crf);
  const bool aom = name == "libaom-av1", vpx = name == "libvpx-vp9" || name == "libvpx";
  if (aom) dictionary.set("cpu-used", options.preset.empty() ? "6" : options.preset);
  if (vpx) dictionary.set("cpu-used", options.preset.empty() ? "2" : options.preset);
  if (aom || name == "libvpx-vp9") dictionary.set("row-mt", "1");
  // VP8 has no alternate reference frames where there is alpha.
  if (name == "libvpx" && has_alpha(*av_pix_fmt_desc_get(encoder.pix_fmt)))
    dictionary.set("auto-alt-ref", "0");
  if (name == "libx264" && options.preset.empty()) dictionary.set("preset", kX264Preset);
  if (name == "libx264") keep_repeatable(dictionary);
  if (!aom && !vpx && !options.preset.empty()) set_named_preset(*encoder.codec, dictionary, options.preset);
  if (name == "libx265") {
    const std::string pools = options.threads > 0 ? ":pools=" + std::to_string(options.threads) : "";
    dictionary.set("x265-params", "log-level=none" + pools);
  }
  if (name == "ffv1") {
    encoder.gop_size = 1;
    encoder.level = 3;
    if (std::min(encoder.width, encoder.height) < kSmallForSlices) {
      encoder.slices = 1;
      dictionary.set("coder", "1");
    }
  }
  set_options(*encoder.codec, dictionary, options.encoder_options);
  // A user may have set it by libav's name. What is no plain number is left to libav.
  const std::string crf = dictionary.value("crf");
  double value = 0;
  const auto [end, status] = std::from_chars(crf.data(), crf.data() + crf.size(), value);
  if (status == std::errc() && end == crf.data() + crf.size()) check_quality(*encoder.codec, value);
}

}  // namespace knotreel::video
