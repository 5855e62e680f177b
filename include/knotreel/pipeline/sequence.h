// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "knotreel/document/reader.h"
#include "knotreel/document/sequence_info.h"
#include "knotreel/video/stream_info.h"

namespace knotreel::pipeline {

/// What a document keeps of the video that it comes from: size, time base, and as metadata all that a writer
/// wants to know (docs/stats.md, "Video in documents").
/// @param source  name of the video. @param degree of the splines.
document::SequenceInfo sequence_info(const video::StreamInfo& stream, const std::string& source, int degree);

/// The other way round; what is missing or makes no sense in the metadata counts as unknown.
video::StreamInfo stream_info(const document::SequenceInfo& info);

/// Ticks that a frame lasts at the frame rate; 0 if that is not known.
std::int64_t nominal_duration(const video::StreamInfo& stream);

/// Ticks that the last frame of a document lasts, as it tells. If it does not: up to the end of its source if
/// that is told, and unless the document ends long before; else as long as the frame rate says, or the frame
/// before.
std::int64_t last_duration(const document::Reader& reader);

/// The last frame of a document. The step to it from the frame before is 0 if it is the only one.
struct LastFrame {
  std::int64_t pts = 0, step = 0, duration = 0;
};

/// What a document has to tell of the duration of its last frame: 0 if last_duration() finds it out.
std::int64_t duration_to_tell(const document::SequenceInfo& info, const LastFrame& last);

}  // namespace knotreel::pipeline
