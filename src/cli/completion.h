// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace knotreel::cli {

/// A script that completes commands and options in bash; what is no option is the name of a file.
std::string bash_completion(const CLI::App& program);

/// Adds `completion`, which prints it. It is for packages, and not in the help.
void add_completion_command(CLI::App& program);

}  // namespace knotreel::cli
