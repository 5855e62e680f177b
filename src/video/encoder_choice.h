// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "knotreel/video/stream_info.h"
#include "knotreel/video/writer.h"
#include "libav.h"

namespace knotreel::video {

/// The encoder for a codec's name, or the default of a container.
/// @throws Error{kInvalidArgument} naming what there is.
const AVCodec* choose_encoder(const std::string& codec, const AVOutputFormat& container);

/// The pixel format of an encoder that keeps most of the source's: depth, chroma, alpha, grey. 4:2:0 and the
/// like are passed over where the encoder cannot do them at an odd size.
/// @param wanted  a name, or empty for the choice.
/// @throws Error{kInvalidArgument} if `wanted` is unknown or not to be had.
AVPixelFormat choose_pixel_format(const AVCodec& encoder, const StreamInfo& frames,
                                  const std::string& wanted);

/// Quality, preset, threads and the user's options in the encoder's own words.
/// @throws Error{kInvalidArgument} for a preset that the encoder does not have, or a quality beyond its
/// scale.
void set_quality(AVCodecContext& encoder, Options& dictionary, const WriteOptions& options);

}  // namespace knotreel::video
