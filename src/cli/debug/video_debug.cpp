// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/video_debug.h"

#include <fmt/core.h>

#include <memory>

#include "cli/debug/debug_pictures.h"

namespace knotreel::cli::debug {

pipeline::Watch watch_into(const std::filesystem::path& folder) {
  const DebugPictures made_if_missing(folder);
  const auto of_frame = [folder](std::uint64_t frame) {
    return std::make_shared<DebugPictures>(folder / fmt::format("frame_{:06}", frame + 1));
  };
  pipeline::Watch watch;
  watch.cold = [of_frame](std::uint64_t frame) -> vectorize::Observer {
    return [pictures = of_frame(frame)](const vectorize::Progress& progress) { pictures->write(progress); };
  };
  watch.stored = [of_frame](std::uint64_t frame, const image::Image& picture,
                            const document::FrameModel& model) {
    of_frame(frame)->write_stored(picture, model);
  };
  return watch;
}

}  // namespace knotreel::cli::debug
