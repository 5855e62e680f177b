#pragma once

#include "knotreel/video/reader.h"
#include "libav.h"

namespace knotreel::video {

/// What container, decoder and first frame tell of a video stream.
StreamInfo describe_stream(AVFormatContext& format, AVStream& stream, const AVCodecContext& decoder,
                           AVFrame& first, const ReadOptions& options);

/// When a track ends, in seconds; 0 if it is not told.
double told_end(const AVStream& stream);

/// All streams, those that are left out too.
std::vector<StreamEntry> list_streams(const AVFormatContext& format);

}  // namespace knotreel::video
