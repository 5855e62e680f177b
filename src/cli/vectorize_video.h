// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include "cli/video_run.h"

namespace knotreel::cli {

/// Adds the options of `vectorize` that only videos have; `run` must live until it has been parsed.
void add_vectorize_video_options(CLI::App& command, VideoRun& run);

/// Makes the document of a video, or one per frame, and tells of it.
/// @throws Error{kInterrupted} after a signal, when the documents are whole.
void vectorize_video(VideoRun run);

}  // namespace knotreel::cli
