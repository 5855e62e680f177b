// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "knotreel/video/reader.h"

/// Which part of a video or of a document is wanted.
namespace knotreel::cli {

struct PartOptions {
  std::string frames;  ///< as parse_frames() takes them; empty: all
  std::string start;   ///< as parse_time() takes it; empty: the first frame
  std::string end;     ///< likewise; empty: up to the end

  bool whole() const { return frames.empty() && start.empty() && end.empty(); }
};

/// Adds them to a command; `options` must live until it has been parsed.
/// @param frames_help of --frames.
void add_part_options(CLI::App& command, PartOptions& options, const std::string& frames_help);

/// @throws Error{kInvalidArgument} for what is no part.
video::Part part_of(const PartOptions& given);

}  // namespace knotreel::cli
