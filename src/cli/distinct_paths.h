// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// That a run does not destroy what it reads, nor one output by another.
namespace knotreel::cli {

/// What a run writes to.
struct Output {
  std::string path;      ///< `-`: standard output; empty: nothing
  bool pattern = false;  ///< files whose names are as video::matches_pattern() says
};

/// A video, or a picture per frame. @param container as video::WriteOptions; `null` and `hash` write no file.
/// @throws Error{kInvalidArgument} for a name with several numbers, as `%d_%d.png`.
Output video_output(const std::string& path, const std::string& container = {});

/// A document per frame in a folder; empty: nothing.
Output split_output(const std::string& folder);

/// Adds `--split DIR`.
void add_split_option(CLI::App& command, std::string& folder);

/// Adds `-n`, `--no-overwrite`: check_paths() refuses outputs that are there already.
void add_no_overwrite_option(CLI::App& command);

/// To be called before any work. Devices and pipes may be named several times.
/// @param inputs  files, `-`, folders and patterns of pictures; empty ones and what is no file do not matter.
/// @throws Error{kInvalidArgument} if an output is the same file as an input or another output, whatever the
/// spelling, also by links; or if several are standard output. Error{kOutput} if one is there already and
/// must not be replaced.
void check_paths(const std::vector<std::string>& inputs, const std::vector<Output>& outputs);

/// Whether one of them is `-`, so that nothing else may be said there.
bool uses_standard_output(const std::vector<Output>& outputs);

}  // namespace knotreel::cli
