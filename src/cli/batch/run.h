// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/batch/picture_job.h"
#include "cli/batch/progress.h"

namespace knotreel::cli::batch {

/// A batch, ready to start.
struct Lot {
  std::vector<Item> items;
  std::map<std::string, Entry> before;  ///< lines of an earlier run; empty: everything is done anew
  Crew crew;
};

/// Does all items: each gets its line in the manifest when it ends, failed or not.
/// @throws Error{kInterrupted} after a signal; Error{kOutput} if the manifest cannot be written; when all has
/// ended, the gravest kind among the items that failed: kOutput, others, kInput.
void run_lot(const Lot& lot, const Job& job, Manifest& manifest, Progress& progress);

}  // namespace knotreel::cli::batch
