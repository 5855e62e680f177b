// SPDX-License-Identifier: GPL-3.0-or-later
#include "readable_frame.h"

extern "C" {
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace knotreel::video {
namespace {

FramePtr blank_like(const AVFrame& frame, AVPixelFormat format) {
  FramePtr result = new_frame();
  result->format = format;
  result->width = frame.width;
  result->height = frame.height;
  if (av_frame_get_buffer(result.get(), 0) < 0) throw std::bad_alloc();
  av_frame_copy_props(result.get(), &frame);
  return result;
}

/// Planes of as many bits and as few chroma samples; AV_PIX_FMT_NONE if there is none.
AVPixelFormat planar_like(const AVPixFmtDescriptor& format) {
  constexpr std::uint64_t kOther = AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_HWACCEL;
  const AVPixFmtDescriptor* d = nullptr;
  while ((d = av_pix_fmt_desc_next(d)) != nullptr) {
    const AVPixelFormat id = av_pix_fmt_desc_get_id(d);
    if (d->nb_components == format.nb_components && (d->flags & kOther) == 0 &&
        av_pix_fmt_count_planes(id) == d->nb_components && d->log2_chroma_w == format.log2_chroma_w &&
        d->log2_chroma_h == format.log2_chroma_h && d->comp[0].depth == format.comp[0].depth &&
        sws_isSupportedInput(id) != 0)
      return id;
  }
  return AV_PIX_FMT_NONE;
}

FramePtr in_planes(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  const AVPixelFormat target = planar_like(format);
  if (target == AV_PIX_FMT_NONE) return {};
  const AVPixFmtDescriptor& planes = *av_pix_fmt_desc_get(target);
  FramePtr result = blank_like(frame, target);
  // libav writes the bits of samples into those that are there.
  for (AVBufferRef* const buffer : result->buf) {
    if (buffer != nullptr) std::fill_n(buffer->data, buffer->size, std::uint8_t{0});
  }
  std::vector<std::uint32_t> line(std::size_t(frame.width));
  std::array<const std::uint8_t*, 4> from{};
  std::copy(frame.data, frame.data + 4, from.begin());
  for (int c = 0; c < format.nb_components; ++c) {
    const bool chroma = c == 1 || c == 2;
    const int width = chroma ? AV_CEIL_RSHIFT(frame.width, format.log2_chroma_w) : frame.width;
    const int height = chroma ? AV_CEIL_RSHIFT(frame.height, format.log2_chroma_h) : frame.height;
    for (int y = 0; y < height; ++y) {
      av_read_image_line2(line.data(), from.data(), frame.linesize, &format, 0, y, c, width, 0, 4);
      av_write_image_line2(line.data(), result->data, result->linesize, &planes, 0, y, c, width, 4);
    }
  }
  return result;
}

FramePtr without_mosaic(const AVFrame& frame, const AVPixFmtDescriptor& format) {
  const AVPixelFormat target = format.comp[0].step > 1 ? AV_PIX_FMT_RGB48LE : AV_PIX_FMT_RGB24;
  const std::unique_ptr<SwsContext, decltype(&sws_freeContext)> scaler(
      sws_getContext(frame.width, frame.height, AVPixelFormat(frame.format), frame.width, frame.height,
                     target, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr),
      &sws_freeContext);
  if (!scaler) return {};
  FramePtr result = blank_like(frame, target);
  sws_scale(scaler.get(), frame.data, frame.linesize, 0, frame.height, result->data, result->linesize);
  return result;
}

}  // namespace

FramePtr readable_frame(const AVFrame& frame) {
  const auto id = AVPixelFormat(frame.format);
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(id);
  if (format == nullptr || (format->flags & AV_PIX_FMT_FLAG_HWACCEL) != 0) return {};
  if ((format->flags & AV_PIX_FMT_FLAG_BAYER) != 0) return without_mosaic(frame, *format);
  const bool is_yuv = (format->flags & AV_PIX_FMT_FLAG_RGB) == 0 && format->nb_components >= 3;
  // In this one luma samples do not follow each other at equal distances, which libav cannot describe.
  if (!is_yuv || sws_isSupportedInput(id) != 0 || id == AV_PIX_FMT_UYYVYY411) return {};
  return in_planes(frame, *format);
}

}  // namespace knotreel::video
