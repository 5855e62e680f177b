// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/video/reader.h"
#include "libav.h"

namespace knotreel::video {

/// What container, decoder and first frame tell of a video stream.
StreamInfo describe_stream(AVFormatContext& format, AVStream& stream, const AVCodecContext& decoder,
                           AVFrame& first, const ReadOptions& options);

/// Takes up what filters have made of the frames: their shape, and their clock if it is another one.
/// @param first  of the frames as they are handed out
void describe_filtered(StreamInfo& info, const AVFrame& first, AVRational time_base, AVRational rate);

/// When a track ends, in seconds; 0 if it is not told.
double told_end(const AVFormatContext& format, const AVStream& stream);

/// All streams, those that are left out too.
std::vector<StreamEntry> list_streams(const AVFormatContext& format);

}  // namespace knotreel::video
