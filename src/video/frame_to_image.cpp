#include "frame_to_image.h"

extern "C" {
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "colour_rules.h"
#include "image_to_frame.h"
#include "knotreel/base/error.h"

namespace knotreel::video {
namespace {

const AVPixFmtDescriptor& descriptor(const AVFrame& frame) {
  const AVPixFmtDescriptor* found = av_pix_fmt_desc_get(AVPixelFormat(frame.format));
  if (found == nullptr) throw Error(ErrorKind::kInput, "frames are of no known pixel format");
  return *found;
}

AVPixelFormat sixteen_bits(int channels) {
  static constexpr AVPixelFormat kFormats[] = {AV_PIX_FMT_GRAY16, AV_PIX_FMT_YA16, AV_PIX_FMT_RGB48,
                                               AV_PIX_FMT_RGBA64};
  return kFormats[channels - 1];
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
        row[std::size_t(x * channels + c)] = inverted ? 255 - value : value;
      }
    }
  }
  return image;
}

/// The top left part of a frame.
image::Image from_sixteen_bits(const AVFrame& frame, int width, int height, int channels) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    const std::span<float> row = image.row(y);
    const auto* from =
        reinterpret_cast<const std::uint16_t*>(frame.data[0] + std::ptrdiff_t(y) * frame.linesize[0]);
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = float(from[i]) / 257.0F;
  }
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

void FrameToImage::prepare(const AVFrame& frame, const AVFrame& target, int shown_height) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  const AVPixelFormat plain_format = without_range(AVPixelFormat(frame.format));
  const bool full = plain_format != frame.format || full_range(frame.color_range, format);
  const int matrix = matrix_in_use(frame.colorspace, shown_height);
  if (scaler_ != nullptr && frame.width == from_width_ && frame.height == from_height_ &&
      frame.format == from_format_ && matrix == from_matrix_ && full == from_full_ &&
      frame.chroma_location == from_place_) {
    return;
  }
  sws_freeContext(scaler_);
  scaler_ = allocated(sws_alloc_context());
  from_width_ = frame.width;
  from_height_ = frame.height;
  from_format_ = frame.format;
  from_matrix_ = matrix;
  from_full_ = full;
  from_place_ = frame.chroma_location;
  set_number(scaler_, "sws_flags",
             SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_BITEXACT);
  set_number(scaler_, "srcw", frame.width);
  set_number(scaler_, "srch", frame.height);
  set_number(scaler_, "src_format", plain_format);
  set_number(scaler_, "src_range", full);
  set_number(scaler_, "dstw", target.width);
  set_number(scaler_, "dsth", target.height);
  set_number(scaler_, "dst_format", target.format);
  set_number(scaler_, "dst_range", 1);
  set_chroma_place(scaler_, format, frame.chroma_location);
  if (sws_init_context(scaler_, nullptr, nullptr) < 0) {
    throw Error(ErrorKind::kInput,
                std::string("frames of pixel format ") + format.name + " cannot be converted");
  }
  const int* coefficients = sws_getCoefficients(matrix);
  sws_setColorspaceDetails(scaler_, coefficients, full, coefficients, 1, 0, 1 << 16, 1 << 16);
}

image::Image FrameToImage::scaled(const AVFrame& frame) {
  const bool same_size = frame.width == width_ && frame.height == height_;
  const FramePtr whole = same_size ? with_whole_cells(frame) : FramePtr();
  const AVFrame& source = whole ? *whole : frame;
  const FramePtr target =
      blank(sixteen_bits(channels_), whole ? source.width : width_, whole ? source.height : height_);
  prepare(source, *target, frame.height);
  sws_scale(scaler_, source.data, source.linesize, 0, source.height, target->data, target->linesize);
  return from_sixteen_bits(*target, width_, height_, channels_);
}

image::Image FrameToImage::convert(const AVFrame& frame) {
  const AVPixFmtDescriptor& format = descriptor(frame);
  if (!plain(format)) return scaled(frame);
  image::Image image = taken_over(frame, channels_of(format));
  if (frame.width != width_ || frame.height != height_) image = resized(image, width_, height_);
  return channels_ == image.channels ? std::move(image) : with_channels(image, channels_);
}

image::Image resized(const image::Image& image, int width, int height) {
  const FramePtr frame = packed_frame(image, sixteen_bits(image.channels), {}, image.height);
  FrameToImage converter(width, height, image.channels);
  return converter.scaled(*frame);
}

}  // namespace knotreel::video
