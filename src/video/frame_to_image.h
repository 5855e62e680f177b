// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"
#include "libav.h"

struct SwsContext;

namespace knotreel::video {

/// Turns decoded frames into Images of one size and number of channels. RGB, palettes, grey and
/// 4:4:4 of the right size are taken over exactly. Missing chroma and other sizes come from swscale at 16
/// bits; the matrix is applied in floats, because swscale's own is off by up to a level of 8 bits. One thread
/// at a time.
class FrameToImage {
 public:
  FrameToImage(int width, int height, int channels) : width_(width), height_(height), channels_(channels) {}
  ~FrameToImage();
  FrameToImage(const FrameToImage&) = delete;
  FrameToImage& operator=(const FrameToImage&) = delete;

  /// @throws Error{kInput} if swscale does not know the format.
  image::Image convert(const AVFrame& frame);

 private:
  void prepare(const AVFrame& frame, const AVFrame& target);
  FramePtr interpolated(const AVFrame& frame);
  image::Image from_yuv(const AVFrame& frame);

  int width_, height_, channels_;
  SwsContext* scaler_ = nullptr;
  // What the scaler was made for.
  int from_width_ = 0, from_height_ = 0, from_format_ = -1, from_place_ = 0;
};

/// A picture of another size, by the same scaler.
image::Image resized(const image::Image& image, int width, int height);

}  // namespace knotreel::video
