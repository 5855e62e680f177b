// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame_to_image.h"

extern "C" {
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "base/multiversion.h"
#include "colour_rules.h"
#include "image_to_frame.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "readable_frame.h"

namespace knotreel::video {
namespace {

const AVPixFmtDescriptor& descriptor(const AVFrame& frame) {
  const AVPixFmtDescriptor* found = av_pix_fmt_desc_get(AVPixelFormat(frame.format));
  if (found == nullptr) throw Error(ErrorKind::kInput, "frames are of no known pixel format");
  return *found;
}

/// Whether the components are those of the Image, so that nothing has to be computed but the scale.
bool plain(const AVPixFmtDescriptor& format) {
  return (is_rgb(format) || is_grey(format)) && (format.flags & AV_PIX_FMT_FLAG_BAYER) == 0 &&
         (format.flags & AV_PIX_FMT_FLAG_HWACCEL) == 0 && format.comp[0].depth <= 32;
}

/// The line from stored values to 0..255.
struct Scale {
  float factor, offset;
};

Scale scale_of(const AVPixFmtDescriptor& format, int component, int tagged_range) {
  if ((format.flags & AV_PIX_FMT_FLAG_FLOAT) != 0) return {255, 0};
  if ((format.flags & AV_PIX_FMT_FLAG_PAL) != 0) return {1, 0};
  const int depth = format.comp[component].depth;
  const bool luma = is_grey(format) && component == 0;
  if (luma && depth >= 8 && !full_range(tagged_range, format)) {
    const float factor = 255.0F / 219.0F / float(1 << (depth - 8));
    return {factor, -16 * 255.0F / 219.0F};
  }
  return {255.0F / float((std::int64_t{1} << depth) - 1), 0};
}

float stored_value(std::uint32_t bits, bool is_float) {
  return is_float ? std::bit_cast<float>(bits) : float(bits);
}

image::Image taken_over(const AVFrame& frame, int channels) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  image::Image image = image::make_image(frame.width, frame.height, channels);
  std::vector<std::uint32_t> line(std::size_t(frame.width));
  const bool palette = (format.flags & AV_PIX_FMT_FLAG_PAL) != 0;
  const bool is_float = (format.flags & AV_PIX_FMT_FLAG_FLOAT) != 0;
  std::array<const std::uint8_t*, 4> planes{};
  std::copy(frame.data, frame.data + 4, planes.begin());
  const bool inverted = frame.format == AV_PIX_FMT_MONOWHITE;
  for (int c = 0; c < channels; ++c) {
    const Scale scale = scale_of(format, c, frame.color_range);
    for (int y = 0; y < frame.height; ++y) {
      av_read_image_line2(line.data(), planes.data(), frame.linesize, &format, 0, y, c, frame.width, palette,
                          4);
      const std::span<float> row = image.row(y);
      for (int x = 0; x < frame.width; ++x) {
        const float value = stored_value(line[std::size_t(x)], is_float) * scale.factor + scale.offset;
        if (is_float && !std::isfinite(value))
          throw Error(ErrorKind::kInput, "a frame holds samples that are not finite");
        row[std::size_t(x * channels + c)] = inverted ? 255 - value : value;
      }
    }
  }
  return image;
}

/// How codes of luma and chroma become RGB.
struct Codes {
  int depth;  ///< of the codes; samples of more bits have fractions of codes
  bool full;
  LumaWeights weights;
};

KNOTREEL_MULTIVERSION
void scale_line(const std::uint32_t* raw, float code, float zero, float factor, std::size_t count,
                float* line) {
  for (std::size_t x = 0; x < count; ++x)
    line[x] = (float(std::int32_t(raw[x])) * code - zero) * factor;  // at most 16 bits
}

/// A line of a component: codes from 0 on, as 0..255 for luma and alpha, about 0 for chroma.
void read_line(const AVFrame& frame, int component, int y, const Codes& codes, std::vector<float>& line) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  thread_local std::vector<std::uint32_t> raw;
  raw.resize(std::size_t(frame.width));
  std::array<const std::uint8_t*, 4> planes{};
  std::copy(frame.data, frame.data + 4, planes.begin());
  av_read_image_line2(raw.data(), planes.data(), frame.linesize, &format, 0, y, component, frame.width, 0, 4);
  const float code = 1.0F / float(1 << (format.comp[component].depth - codes.depth));
  const float step = float(1 << (codes.depth - 8));
  const bool chroma = component == 1 || component == 2, full = codes.full || component == 3;
  const float zero = chroma ? 128 * step : full ? 0 : 16 * step;
  const float range = full ? float((1 << codes.depth) - 1) : (chroma ? 224 : 219) * step;
  line.resize(raw.size());
  scale_line(raw.data(), code, zero, 255.0F / range, line.size(), line.data());
}

template <std::size_t Channels>
[[gnu::always_inline]] inline void colours_of(const float* __restrict luma, const float* __restrict blue,
                                              const float* __restrict red, const LumaWeights& weights,
                                              std::size_t count, float* __restrict pixels) {
  const float to_red = 2 * (1 - weights.red), to_blue = 2 * (1 - weights.blue);
  const float wr = weights.red, wg = weights.green(), wb = weights.blue;
  const auto clamped = [](float value) {
    const float low = value < 0 ? 0 : value;
    return low > 255 ? 255 : low;
  };
  for (std::size_t x = 0; x < count; ++x) {
    const float r = luma[x] + to_red * red[x], b = luma[x] + to_blue * blue[x];
    const float g = (luma[x] - wr * r - wb * b) / wg;
    float* const p = pixels + x * Channels;
    p[0] = clamped(r);
    p[1] = clamped(g);
    p[2] = clamped(b);
  }
}

/// RGB of a line, with room for alpha or without.
KNOTREEL_MULTIVERSION
void colour_line(const float* luma, const float* blue, const float* red, const LumaWeights& weights,
                 std::size_t channels, std::size_t count, float* pixels) {
  if (channels == 3) return colours_of<3>(luma, blue, red, weights, count, pixels);
  return colours_of<4>(luma, blue, red, weights, count, pixels);
}

/// The top left part of a frame that has chroma for every pixel.
image::Image from_luma_and_chroma(const AVFrame& frame, int width, int height, const Codes& codes) {
  const bool alpha = has_alpha(descriptor(frame));
  image::Image image = image::make_image(width, height, alpha ? 4 : 3);
  parallel_for(std::size_t(height), [&](std::size_t row) {
    const int y = int(row);
    thread_local std::vector<float> luma, blue, red;
    read_line(frame, 0, y, codes, luma);
    read_line(frame, 1, y, codes, blue);
    read_line(frame, 2, y, codes, red);
    colour_line(luma.data(), blue.data(), red.data(), codes.weights, std::size_t(image.channels),
                std::size_t(width), image.row(y).data());
    if (!alpha) return;
    read_line(frame, 3, y, codes, luma);
    for (std::size_t x = 0; x < std::size_t(width); ++x) image.at(int(x), y, 3) = luma[x];
  });
  return image;
}

void set_number(SwsContext* scaler, const char* name, std::int64_t value) {
  av_opt_set_int(scaler, name, value, 0);
}

/// swscale counts in 1/256 of a luma pixel, and only where there are fewer chroma samples than luma samples.
void set_chroma_place(SwsContext* scaler, const AVPixFmtDescriptor& format, int tagged) {
  if (is_rgb(format) || is_grey(format)) return;
  const ChromaPlace place = chroma_place(tagged);
  if (format.log2_chroma_w == 1) set_number(scaler, "src_h_chr_pos", std::int64_t(place.x * 256));
  if (format.log2_chroma_h == 1) set_number(scaler, "src_v_chr_pos", std::int64_t(place.y * 256));
}

FramePtr blank(AVPixelFormat format, int width, int height) {
  FramePtr frame = new_frame();
  frame->format = format;
  frame->width = width;
  frame->height = height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  return frame;
}

/// The frame with whole cells of chroma at the right and the bottom; null if it has them. swscale would
/// stretch the chroma of an odd size a little, so that it lies beside its luma.
FramePtr with_whole_cells(const AVFrame& frame) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  const int width = FFALIGN(frame.width, 1 << format.log2_chroma_w);
  const int height = FFALIGN(frame.height, 1 << format.log2_chroma_h);
  if (width == frame.width && height == frame.height) return {};
  FramePtr whole = blank(AVPixelFormat(frame.format), width, height);
  av_frame_copy_props(whole.get(), &frame);
  if (av_frame_copy(whole.get(), &frame) < 0) throw std::bad_alloc();
  return whole;
}

}  // namespace

FrameToImage::~FrameToImage() {
  sws_freeContext(scaler_);
}

void FrameToImage::prepare(const AVFrame& frame, const AVFrame& target) {
  if (scaler_ != nullptr && frame.width == from_width_ && frame.height == from_height_ &&
      frame.format == from_format_ && frame.chroma_location == from_place_) {
    return;
  }
  sws_freeContext(scaler_);
  scaler_ = allocated(sws_alloc_context());
  from_width_ = frame.width;
  from_height_ = frame.height;
  from_format_ = frame.format;
  from_place_ = frame.chroma_location;
  set_number(scaler_, "sws_flags",
             SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT);
  set_number(scaler_, "srcw", frame.width);
  set_number(scaler_, "srch", frame.height);
  set_number(scaler_, "src_format", without_range(AVPixelFormat(frame.format)));
  set_number(scaler_, "dstw", target.width);
  set_number(scaler_, "dsth", target.height);
  set_number(scaler_, "dst_format", target.format);
  // Codes stay what they are: the same range on both sides, whichever it is.
  set_number(scaler_, "src_range", 0);
  set_number(scaler_, "dst_range", 0);
  set_chroma_place(scaler_, descriptor(frame), frame.chroma_location);
  if (sws_init_context(scaler_, nullptr, nullptr) >= 0) return;
  sws_freeContext(std::exchange(scaler_, nullptr));  // not to be taken for one that is ready
  throw Error(ErrorKind::kInput,
              std::string("frames of pixel format ") + descriptor(frame).name + " cannot be converted");
}

/// The frame at the size wanted and with chroma for every pixel, in 16 bits of which the upper ones are
/// codes.
FramePtr FrameToImage::interpolated(const AVFrame& frame) {
  const bool same_size = frame.width == width_ && frame.height == height_;
  const FramePtr whole = same_size ? with_whole_cells(frame) : FramePtr();
  const AVFrame& source = whole ? *whole : frame;
  const AVPixelFormat format = has_alpha(descriptor(frame)) ? AV_PIX_FMT_YUVA444P16 : AV_PIX_FMT_YUV444P16;
  FramePtr target = blank(format, whole ? source.width : width_, whole ? source.height : height_);
  prepare(source, *target);
  const int rows =
      sws_scale(scaler_, source.data, source.linesize, 0, source.height, target->data, target->linesize);
  if (rows != target->height) throw Error(ErrorKind::kInput, "a frame cannot be converted");
  return target;
}

image::Image FrameToImage::from_yuv(const AVFrame& frame) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  const bool full =
      without_range(AVPixelFormat(frame.format)) != frame.format || full_range(frame.color_range, format);
  const Codes codes{format.comp[0].depth, full, luma_weights(matrix_in_use(frame.colorspace, frame.height))};
  const bool ready = frame.width == width_ && frame.height == height_ && format.log2_chroma_w == 0 &&
                     format.log2_chroma_h == 0;
  if (ready) return from_luma_and_chroma(frame, width_, height_, codes);
  return from_luma_and_chroma(*interpolated(frame), width_, height_, codes);
}

image::Image FrameToImage::convert(const AVFrame& frame) {
  if (const FramePtr readable = readable_frame(frame)) return convert(*readable);
  const AVPixFmtDescriptor& format = descriptor(frame);
  const bool exact = plain(format);
  if (!exact && (is_rgb(format) || is_grey(format) || format.comp[0].depth < 8)) {
    throw Error(ErrorKind::kInput,
                std::string("frames of pixel format ") + format.name + " cannot be converted");
  }
  image::Image image = exact ? taken_over(frame, channels_of(format)) : from_yuv(frame);
  if (image.width != width_ || image.height != height_) image = resized(image, width_, height_);
  return channels_ == image.channels ? std::move(image) : with_channels(image, channels_);
}

image::Image resized(const image::Image& image, int width, int height) {
  // By way of full-range luma and chroma, which hold all of RGB but for rounding in the 16th bit.
  const ColourTags tags{AVCOL_RANGE_JPEG, AVCOL_SPC_BT709, 2, 2, 0};
  const AVPixelFormat format = image.has_alpha() ? AV_PIX_FMT_YUVA444P16 : AV_PIX_FMT_YUV444P16;
  const FramePtr frame = packed_frame(image, format, tags, image.height);
  frame->color_range = AVCOL_RANGE_JPEG;
  frame->colorspace = AVCOL_SPC_BT709;
  return FrameToImage(width, height, image.channels).convert(*frame);
}

}  // namespace knotreel::video
