// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress_line.h"

#include <fmt/core.h>

#include "cli/command.h"
#include "cli/printable.h"
#include "cli/standard_error.h"

namespace knotreel::cli {

ProgressLine::ProgressLine() : terminal_(shows_live_line()) {}

ProgressLine::~ProgressLine() {
  if (terminal_) put_error(kClearLine);
}

void ProgressLine::show(const std::string& stage) {
  if (!terminal_) return;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
  put_error(fmt::format("{}knotreel: {} done after {:.1f} s", kClearLine, printable(stage), passed.count()));
}

}  // namespace knotreel::cli
