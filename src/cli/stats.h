// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "knotreel/vectorize/vectorize.h"

/// Parts of what `knotreel vectorize --stats` writes; the whole is told in docs/stats.md.
namespace knotreel::cli {

/// Seconds spent in each stage, in order.
class StageTimer {
 public:
  /// The time since the last stage was that of this one.
  void finish(const std::string& stage);
  /// Seconds since the last stage.
  double running() const;
  /// Takes so much from the stage that is running and gives it to another.
  void attribute(const std::string& stage, double seconds);
  /// All stages and, last, their total.
  nlohmann::ordered_json seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double elsewhere_ = 0;
  nlohmann::ordered_json seconds_ = nlohmann::ordered_json::object();
};

/// Members chains, over_budget, pixels, polyline_vertices, folds_left, dropped.
nlohmann::ordered_json features_json(const vectorize::Report& report);

/// One member per round, with name, counts, errors and milliseconds of its stages.
nlohmann::ordered_json rounds_json(const vectorize::Report& report);

}  // namespace knotreel::cli
