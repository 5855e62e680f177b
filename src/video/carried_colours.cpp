// SPDX-License-Identifier: GPL-3.0-or-later
#include "carried_colours.h"

#include <string>

namespace knotreel::video {
namespace {

/// What there is room for.
struct Room {
  bool matrix = false;
  bool range = false;
};

Room room_in(AVCodecID codec) {
  switch (codec) {
    case AV_CODEC_ID_H264:
    case AV_CODEC_ID_HEVC:
    case AV_CODEC_ID_VP9:
    case AV_CODEC_ID_AV1:
    case AV_CODEC_ID_DIRAC:
    // Whoever asks for these wants samples as they are.
    case AV_CODEC_ID_RAWVIDEO:
    case AV_CODEC_ID_WRAPPED_AVFRAME:
      return {.matrix = true, .range = true};
    case AV_CODEC_ID_MPEG2VIDEO:
    case AV_CODEC_ID_PRORES:
      return {.matrix = true};
    default:
      return {};
  }
}

/// Their luma has the whole range, though libav has a mark of its own for another.
bool is_jpeg(AVCodecID codec) {
  return codec == AV_CODEC_ID_MJPEG || codec == AV_CODEC_ID_AMV;
}

/// Codecs that are defined as BT.601, whatever a container says.
bool is_always_601(AVCodecID codec) {
  return codec == AV_CODEC_ID_VP8 || codec == AV_CODEC_ID_SPEEDHQ || is_jpeg(codec);
}

/// Whether chroma is between luma samples in all directions; elsewhere it is left of them if nobody tells.
bool is_always_centred(AVCodecID codec) {
  return codec == AV_CODEC_ID_MPEG1VIDEO || codec == AV_CODEC_ID_H263 || codec == AV_CODEC_ID_H263P ||
         codec == AV_CODEC_ID_SPEEDHQ || codec == AV_CODEC_ID_THEORA || is_jpeg(codec);
}

bool has_room_for_all(const AVOutputFormat& container) {
  const std::string name = container.name;
  return name == "matroska" || name == "webm";
}

}  // namespace

ColourTags carried_colours(const ColourTags& tags, AVCodecID codec, const AVOutputFormat& container) {
  ColourTags carried = tags;
  const Room room = room_in(codec);
  const bool all = has_room_for_all(container);
  if (is_always_601(codec)) {
    carried.matrix = AVCOL_SPC_BT470BG;
  } else if (!room.matrix && !all) {
    carried.matrix = AVCOL_SPC_UNSPECIFIED;
  }
  if (is_jpeg(codec)) {
    carried.range = AVCOL_RANGE_JPEG;
  } else if (codec == AV_CODEC_ID_VP8 || (!room.range && !all)) {
    carried.range = AVCOL_RANGE_UNSPECIFIED;
  }
  if (is_always_centred(codec)) {
    carried.chroma_location = AVCHROMA_LOC_CENTER;
  } else if (codec != AV_CODEC_ID_H264 && codec != AV_CODEC_ID_HEVC && !room.range && !all) {
    carried.chroma_location = AVCHROMA_LOC_UNSPECIFIED;
  }
  return carried;
}

}  // namespace knotreel::video
