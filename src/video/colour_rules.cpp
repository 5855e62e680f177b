// SPDX-License-Identifier: GPL-3.0-or-later
#include "colour_rules.h"

#include <algorithm>

namespace knotreel::video {

int matrix_in_use(int tagged, int height) {
  switch (tagged) {
    case AVCOL_SPC_BT709:
    case AVCOL_SPC_FCC:
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_SMPTE240M:
    case AVCOL_SPC_BT2020_NCL:
      return tagged;
    case AVCOL_SPC_BT2020_CL:  // nearest that is linear
      return AVCOL_SPC_BT2020_NCL;
    default:
      return height < 720 ? AVCOL_SPC_SMPTE170M : AVCOL_SPC_BT709;
  }
}

bool full_range(int tagged, const AVPixFmtDescriptor& format) {
  if (tagged == AVCOL_RANGE_UNSPECIFIED) return is_grey(format);
  return tagged == AVCOL_RANGE_JPEG;
}

LumaWeights luma_weights(int matrix) {
  switch (matrix) {
    case AVCOL_SPC_BT709:
      return {0.2126F, 0.0722F};
    case AVCOL_SPC_FCC:
      return {0.30F, 0.11F};
    case AVCOL_SPC_SMPTE240M:
      return {0.212F, 0.087F};
    case AVCOL_SPC_BT2020_NCL:
      return {0.2627F, 0.0593F};
    default:
      return {0.299F, 0.114F};
  }
}

ChromaPlace chroma_place(int tagged) {
  switch (tagged) {
    case AVCHROMA_LOC_CENTER:
      return {0.5, 0.5};
    case AVCHROMA_LOC_TOPLEFT:
      return {0, 0};
    case AVCHROMA_LOC_TOP:
      return {0.5, 0};
    case AVCHROMA_LOC_BOTTOMLEFT:
      return {0, 1};
    case AVCHROMA_LOC_BOTTOM:
      return {0.5, 1};
    default:
      return {0, 0.5};
  }
}

AVPixelFormat without_range(AVPixelFormat format) {
  switch (format) {
    case AV_PIX_FMT_YUVJ420P:
      return AV_PIX_FMT_YUV420P;
    case AV_PIX_FMT_YUVJ422P:
      return AV_PIX_FMT_YUV422P;
    case AV_PIX_FMT_YUVJ444P:
      return AV_PIX_FMT_YUV444P;
    case AV_PIX_FMT_YUVJ440P:
      return AV_PIX_FMT_YUV440P;
    case AV_PIX_FMT_YUVJ411P:
      return AV_PIX_FMT_YUV411P;
    default:
      return format;
  }
}

bool is_rgb(const AVPixFmtDescriptor& format) {
  return (format.flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) != 0;
}

bool is_grey(const AVPixFmtDescriptor& format) {
  return !is_rgb(format) && format.nb_components <= 2;
}

bool has_alpha(const AVPixFmtDescriptor& format) {
  return (format.flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
}

int channels_of(const AVPixFmtDescriptor& format) {
  return (is_grey(format) ? 1 : 3) + (has_alpha(format) ? 1 : 0);
}

int depth_of(const AVPixFmtDescriptor& format) {
  // Packed 5-6-5 and the like: the best component counts.
  int depth = 1;
  for (int i = 0; i < format.nb_components; ++i) depth = std::max(depth, format.comp[i].depth);
  return depth;
}

}  // namespace knotreel::video
