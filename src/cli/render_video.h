// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/distinct_paths.h"
#include "cli/video_options.h"
#include "knotreel/document/reader.h"
#include "knotreel/image/format.h"

namespace knotreel::cli {

/// What `render` is asked to do.
struct RenderArguments {
  std::string input;
  std::string output;
  std::string format;
  double scale = 1;
  std::string size;
  std::string crop;  ///< in pixels of the whole; empty: all of it
  std::string background;
  std::string depth;  ///< 8, 16 or float; empty: of pictures that of their format, of videos as stored
  bool aliased = false;
  int threads = 0;
  std::uint64_t frame = 0;  ///< of pictures
  // The rest is for videos.
  PartOptions part;
  std::string fps;     ///< empty: times as stored
  std::string copied;  ///< video whose other streams go along; empty: none
  std::string progress;
  std::string stats;
  VideoOutputOptions encoding;
};

/// Adds the options that only videos have; `options` must live until it has been parsed.
void add_render_video_options(CLI::App& command, RenderArguments& options);

/// Whether a name, or else a format that is given, means a video or a picture for each frame.
bool is_video_output(const std::string& output, const std::string& format);

/// Of --depth, for pictures; none if it is not given.
std::optional<image::SampleType> samples_of(const RenderArguments& arguments);

std::vector<Output> outputs_of(const RenderArguments& arguments);

/// What can be told before the document is read. @throws Error{kInvalidArgument}.
void check_video(const RenderArguments& arguments);

/// @param reader  of the document, at its start.
/// @throws Error{kInterrupted} after a signal, when the video is whole.
void render_video(const RenderArguments& arguments, document::Reader& reader);

}  // namespace knotreel::cli
