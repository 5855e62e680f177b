// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/bench/clips.h"

namespace knotreel::cli::bench {

/// How a clip is worked on.
struct Setting {
  std::string preset;
  std::vector<int> threads;                ///< a run for each
  std::vector<std::string> encoding;       ///< options of `transcode` that its passthrough has too
  std::vector<std::string> vectorization;  ///< the other options of `transcode`
};

/// Measures one clip with one setting: a run per number of threads, each a process of its own, with a
/// passthrough before it. Members are told of in docs/benchmarks.md.
/// @return a JSON object per run.
nlohmann::ordered_json measure_clip(const Clip& clip, const Setting& setting, const Scratch& scratch);

/// Speed of the frames of one kind, cold or warm, and means of their stages. Models are made one after the
/// other, so a frame takes from the end of the model before to the end of its own; the end of its encoding
/// would not do, because several frames are on their way at once.
/// @param stats as `transcode` writes them. @return an object with `frames`, `fps`, `milliseconds`, `model`;
/// fps is null without frames.
nlohmann::ordered_json frames_json(const nlohmann::ordered_json& stats, bool warm);

}  // namespace knotreel::cli::bench
