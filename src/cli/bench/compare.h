// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace knotreel::cli::bench {

/// What is compared of a file of `knotreel bench --json`.
struct Result {
  struct Run {
    std::string name;  ///< clip, size, preset, number of threads
    nlohmann::ordered_json figures;
  };
  std::string commit;
  std::string date;
  std::vector<Run> runs;
};

/// @throws nlohmann::json::exception if it is none.
Result result_of(const nlohmann::ordered_json& json);

/// Ratios AFTER / BEFORE of all figures of the runs that both results have, a line each; a `*` where they
/// differ by more than the threshold, or by more than 0.2 dB for a PSNR. Runs of one result only are named.
/// @param threshold share, such as 0.1.
std::string comparison_text(const Result& before, const Result& after, double threshold);

}  // namespace knotreel::cli::bench
