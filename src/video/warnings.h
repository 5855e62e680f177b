// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace knotreel::video {

/// Lines of warning. What may happen in every frame is one line with a count, so the list stays short.
class Warnings {
 public:
  void add(const std::string& line) { lines_.push_back(line); }

  /// Counts one more, and rewrites the line that tells how many: "3 <what>".
  void count(const std::string& what);

  const std::vector<std::string>& lines() const { return lines_; }

 private:
  struct Counter {
    std::string what;
    std::uint64_t count;
    std::size_t line;
  };
  std::vector<std::string> lines_;
  std::vector<Counter> counters_;
};

inline void Warnings::count(const std::string& what) {
  for (Counter& counter : counters_) {
    if (counter.what != what) continue;
    lines_[counter.line] = std::to_string(++counter.count) + " " + what;
    return;
  }
  counters_.push_back({what, 1, lines_.size()});
  lines_.push_back("1 " + what);
}

}  // namespace knotreel::video
