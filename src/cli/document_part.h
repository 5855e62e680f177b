// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cli/parse.h"
#include "knotreel/document/reader.h"
#include "knotreel/video/reader.h"

namespace knotreel::cli {

/// Which frames of a document a part means: by number, or by time, counted from the first frame as in videos.
/// @throws Error{kInvalidArgument} if there is no frame at these times.
FrameRange frames_of(const document::Reader& reader, const video::Part& part);

/// The same for frames with these times, in ticks of so many seconds. @pre there is one.
FrameRange frames_of(const std::vector<std::int64_t>& times, double tick, const video::Part& part);

/// How many frames these are. @throws Error{kInvalidArgument} if the document has not all of them.
std::size_t frames_in(const FrameRange& range, const document::Reader& reader);
std::size_t frames_in(const FrameRange& range, std::size_t count);  ///< of so many

}  // namespace knotreel::cli
