// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace knotreel::cli::bench {

/// What figures depend on besides the arguments: `version`, `commit`, `date`, `machine`, `compiler`.
nlohmann::ordered_json surroundings_json();

}  // namespace knotreel::cli::bench
