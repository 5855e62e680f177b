// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/progress.h"

#include <fmt/core.h>

#include <cmath>

#include "cli/command.h"
#include "cli/metrics_report.h"
#include "cli/printable.h"
#include "cli/standard_error.h"

namespace knotreel::cli::batch {
namespace {

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string line_of(const Entry& entry) {
  if (entry.status != "done" || !entry.figures) return entry.item.output + ": " + entry.status;
  const Figures& f = *entry.figures;
  return fmt::format("{}: {} knots, {} control points, {} bytes, PSNR {}, {:.1f} s", entry.item.output,
                     f.knots, f.control_points, f.file_bytes, psnr_text(f.psnr), entry.seconds);
}

}  // namespace

Progress::Progress(std::size_t total, Telling telling) : telling_(telling), terminal_(shows_live_line()) {
  counts_.total = total;
}

Progress::~Progress() {
  clear();
}

void Progress::add(const Entry& entry) {
  const std::lock_guard lock(mutex_);
  ++(entry.status == "done" ? counts_.done : entry.status == "failed" ? counts_.failed : counts_.skipped);
  clear();
  if (entry.status == "failed") {
    put_error_line(entry.error);
  } else if (telling_ == Telling::kItems) {
    tell_result(printable(line_of(entry)) + "\n");
  }
  show();
}

void Progress::tick() {
  const std::lock_guard lock(mutex_);
  show();
}

void Progress::finish() {
  clear();
  if (telling_ == Telling::kNothing) return;
  tell_result(fmt::format("{}: {} done, {} failed, {} skipped in {:.1f} s\n", counted(counts_.total, "item"),
                          counts_.done, counts_.failed, counts_.skipped, seconds()));
}

void Progress::clear() {
  if (terminal_) put_error(kClearLine);
}

void Progress::show() {
  if (!terminal_) return;
  std::string text = fmt::format("knotreel: {} of {}", counts_.ended(), counted(counts_.total, "item"));
  if (counts_.failed > 0) text += fmt::format(", {} failed", counts_.failed);
  // What was skipped took no time, and says nothing of what is to come.
  if (const std::size_t made = counts_.done + counts_.failed; made > 0) {
    const double rate = double(made) / seconds();
    const double left = double(counts_.total - counts_.ended());
    text += fmt::format(", {:.2g} per second, {} to go", rate, duration_text(left / rate));
  }
  put_error(kClearLine + text);
}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace knotreel::cli::batch
