// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "knotreel/pipeline/job.h"

namespace knotreel::pipeline {

/// A document that becomes a video.
struct RenderJob {
  document::Reader* reader = nullptr;  ///< outlives the run
  std::size_t first = 0;               ///< place of the first frame in the document
  std::optional<std::size_t> last;     ///< place of the last one, itself included; none: the end
  /// Frames per second, each made from those before and after it where these are of one group; unknown:
  /// frames and times as stored.
  video::Rational rate;
  /// The video that the document was made from: its sound, subtitles and titles go along, in time with the
  /// frames. Outlives the run; or null.
  video::VideoReader* copied = nullptr;
  VideoOutput video;
  int frames_in_flight = 0;  ///< as in Job
  Stop stop;
  FrameObserver on_frame;  ///< figures that only the making of a model knows are 0
};

/// How many frames run_render() draws. @throws as that.
std::uint64_t frame_count(const RenderJob& job);

/// Draws and encodes all frames, many at once. Frames keep the times of the document.
/// @throws Error{kInvalidArgument} if there are no such frames, and as run_graph().
Summary run_render(const RenderJob& job);

}  // namespace knotreel::pipeline
