// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace knotreel::cli {

/// The page of `man knotreel`: what --help says of the program and of all its commands, for troff.
std::string manual_page(const CLI::App& program);

/// Adds `manual`, which prints it. It is for packages, and not in the help.
void add_manual_command(CLI::App& program);

}  // namespace knotreel::cli
