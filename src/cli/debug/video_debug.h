// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "knotreel/pipeline/job.h"

namespace knotreel::cli::debug {

/// The pictures of `--debug-dir` for a video: a folder for each frame, frame_000001 for the first one. Frames
/// that start a group get those of every stage, all frames those of the model as it was stored.
/// @throws Error{kOutput} if the folder cannot be made, and from within if a picture cannot be written.
pipeline::Watch watch_into(const std::filesystem::path& folder);

}  // namespace knotreel::cli::debug
