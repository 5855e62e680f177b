// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace knotreel::track {

/// Times of the stages of a frame, one after the other.
class Laps {
 public:
  using List = std::vector<std::pair<std::string, double>>;  ///< milliseconds per stage, in order

  /// @param list that stages are added to; must outlive this.
  explicit Laps(List& list) : list_(&list) {}

  /// What has been done since the last one.
  void lap(const char* stage) {
    const Clock::time_point now = Clock::now();
    list_->emplace_back(stage, std::chrono::duration<double, std::milli>(now - clock_).count());
    clock_ = now;
  }

  /// Adds what was timed elsewhere, and starts the clock again.
  void add(const List& laps) {
    list_->insert(list_->end(), laps.begin(), laps.end());
    clock_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  List* list_;
  Clock::time_point clock_ = Clock::now();
};

}  // namespace knotreel::track
