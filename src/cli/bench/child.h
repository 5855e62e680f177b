// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cli/bench/scratch.h"

namespace knotreel::cli::bench {

struct ChildResult {
  double seconds = 0;  ///< from its start to its end
  std::string output;  ///< of its standard output
};

/// Runs this very program with other arguments and waits for it.
/// @throws Error with the last line that it wrote to standard error, of the kind that its exit code tells.
ChildResult run_self(const std::vector<std::string>& arguments, const Scratch& scratch);

}  // namespace knotreel::cli::bench
