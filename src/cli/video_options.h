// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/part_options.h"
#include "knotreel/track/tracker.h"
#include "knotreel/video/reader.h"
#include "knotreel/video/writer.h"

/// The options of all commands that read or write videos.
namespace knotreel::cli {

/// Of the options that only videos have, in the help of commands that also take pictures.
inline constexpr const char* kVideoGroup = "Videos";

struct VideoInputOptions {
  std::string format;
  std::vector<std::string> demuxer;  ///< "key=value"
  std::string image_rate = "25";
  bool image_rate_is_told = false;
  std::string deinterlace = "auto";
  std::string filter;
  PartOptions part;
  bool strict = false;
  bool no_copy_streams = false;
};

struct VideoOutputOptions {
  std::string codec;
  double crf = -1;
  std::string preset;
  std::string pixel_format;
  std::vector<std::string> encoder;    ///< "key=value"
  std::vector<std::string> container;  ///< "key=value"
};

/// Adds them to a command; `options` must live until it has been parsed.
void add_video_input_options(CLI::App& command, VideoInputOptions& options);
/// "auto", "no", "all" or "fields".
void add_deinterlace_option(CLI::App& command, std::string& mode);
video::Deinterlace deinterlace_mode(const std::string& name);

void add_video_output_options(CLI::App& command, VideoOutputOptions& options);
void add_progress_option(CLI::App& command, std::string& file);
void add_trace_option(CLI::App& command, std::string& file);
/// @param no_drawn_frames drawings are frames like others.
void add_tracking_options(CLI::App& command, track::TrackOptions& options, bool& no_drawn_frames);

/// @throws Error{kInvalidArgument} for a rate that is none, or an option without "=".
video::ReadOptions read_options(const VideoInputOptions& given, int threads);

/// @param container as video::WriteOptions. @throws Error{kInvalidArgument} for an option without "=".
video::WriteOptions write_options(const VideoOutputOptions& given, const std::string& container, int threads);

/// Warns of a file that is named although the format writes none; `-` is what ffmpeg wants named then.
void warn_if_not_written(const std::string& output, const std::string& format);

/// As docs/stats.md tells.
nlohmann::ordered_json tracking_json(const track::TrackOptions& options);

}  // namespace knotreel::cli
