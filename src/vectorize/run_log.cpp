// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/run_log.h"

#include <utility>

namespace knotreel::vectorize {

void RunLog::begin_round(std::string name) {
  report.rounds.emplace_back();
  round().name = std::move(name);
  start_ = Clock::now();
}

void RunLog::lap(const char* stage) {
  const auto now = Clock::now();
  round().milliseconds.emplace_back(stage, std::chrono::duration<double, std::milli>(now - start_).count());
  start_ = now;
}

void RunLog::show(const std::string& stage) {
  if (!observer_) return;
  progress.stage = stage;
  observer_(progress);
  start_ = Clock::now();
}

void RunLog::step(const std::string& stage) const {
  if (observer_) observer_({.stage = stage, .picture = progress.picture});
}

}  // namespace knotreel::vectorize
