// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

/// What `knotreel bench` prints of its JSON.
namespace knotreel::cli::bench {

/// Machine, compiler, commit and date in one line.
std::string surroundings_text(const nlohmann::ordered_json& result);

/// A block with a column for each of the runs of one clip and setting.
std::string runs_text(const nlohmann::ordered_json& runs);

/// Two tables in Markdown, the figures of all runs and their stages.
std::string markdown(const nlohmann::ordered_json& result);

}  // namespace knotreel::cli::bench
