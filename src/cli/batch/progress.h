// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <mutex>

#include "cli/batch/manifest.h"

namespace knotreel::cli::batch {

/// How many items ended how.
struct Counts {
  std::size_t total = 0;
  std::size_t done = 0;
  std::size_t failed = 0;
  std::size_t skipped = 0;

  std::size_t ended() const { return done + failed + skipped; }
};

/// How much of the progress goes to standard output.
enum class Telling { kNothing, kSum, kItems };

/// Tells how the lot is getting on. Errors go to standard error, lines about items and the sum to standard
/// output, and a line that is gone afterwards to a terminal. Safe to use from several threads.
class Progress {
 public:
  Progress(std::size_t total, Telling telling);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// An item has ended.
  void add(const Entry& entry);
  /// Shows the line anew, if there is a terminal.
  void tick();
  /// "12 items: 10 done, 2 failed, 0 skipped in 3.4 s", on standard output. Call it when all has ended.
  void finish();

  /// For when all has ended.
  const Counts& counts() const { return counts_; }

 private:
  void clear();
  void show();
  double seconds() const;

  std::mutex mutex_;
  Counts counts_;
  Telling telling_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace knotreel::cli::batch
