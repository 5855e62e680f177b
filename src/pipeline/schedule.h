#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/pipeline/render_job.h"

namespace knotreel::pipeline {

/// Which frame of a document is shown when.
struct Showing {
  std::size_t frame = 0;  ///< place in the document
  double share = 0;       ///< of the way to the next frame, below 1; see track::between()
  std::int64_t pts = 0;
  std::int64_t duration = 0;
};

struct Schedule {
  video::StreamInfo stream;  ///< of what is to be written
  std::vector<Showing> frames;
  /// Time of the source that the times of the frames count from, in ticks of the document.
  std::int64_t origin = 0;
};

/// @throws Error{kInvalidArgument} if the job's range is not in the document.
Schedule make_schedule(const RenderJob& job);

}  // namespace knotreel::pipeline
