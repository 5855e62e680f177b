#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace knotreel::cli::bench {

/// Ratios AFTER / BEFORE of all figures of the runs that both results have, a line each; a `*` where they
/// differ by more than the threshold, or by more than 0.2 dB for a PSNR. Runs of one result only are named.
/// @param threshold share, such as 0.1.
std::string comparison_text(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                            double threshold);

}  // namespace knotreel::cli::bench
