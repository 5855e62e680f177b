// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

/// The subcommands. Each function adds one to the program: its options, its help, and a callback that does
/// the work and throws Error. Nothing here prints errors; main() does.
namespace knotreel::cli {

void add_vectorize_command(CLI::App& program);
void add_transcode_command(CLI::App& program);
void add_batch_command(CLI::App& program);
void add_render_command(CLI::App& program);
void add_export_command(CLI::App& program);
void add_copy_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_dump_command(CLI::App& program);
void add_compare_command(CLI::App& program);
void add_bench_command(CLI::App& program);

/// The commands that the help names.
std::vector<const CLI::App*> shown_commands(const CLI::App& program);

/// Adds `--threads N` to a command; `threads` stays 0 (all cores) if it is not given.
void add_threads_option(CLI::App& command, int& threads);

/// Adds `-q`, `--quiet`: neither tell_result() nor progress say anything then.
void add_quiet_option(CLI::App& command);

bool is_quiet();

/// Whether there is a terminal for a live line of progress, and one is wanted.
bool shows_live_line();

/// Writes what was made to standard output, if that is wanted.
void tell_result(const std::string& text);

/// Adds `--background COLOUR`, for parse_background(); `colour` stays empty if it is not given.
void add_background_option(CLI::App& command, std::string& colour);

/// For check(): a number from `low` to `high`. CLI::Range lets "nan" through.
CLI::Validator within(double low, double high);

/// Adds `--frame N`.
void add_frame_option(CLI::App& command, std::uint64_t& frame, const std::string& description);

/// Writes to standard output, or to a file if `path` is not "-". A full disk is Error{kOutput}.
void write_text(const std::string& path, const std::string& text);

/// One line on standard error, "knotreel: warning: ...", for what is done but may surprise.
void warn(const std::string& message);

void warn_all(const std::vector<std::string>& messages);

/// The same for each of these, with the name of the file that they are about.
void warn_of(const std::string& path, const std::vector<std::string>& messages);

/// The names of the options of a group of the help that were given.
std::vector<std::string> options_given(const CLI::App& command, const std::string& group);

/// "--output" and so on, of all options of a command.
std::vector<std::string> long_names(const CLI::App& command);

/// "knotreel 0.1.0 (OpenCV ..., ...)".
std::string version_text();

}  // namespace knotreel::cli
