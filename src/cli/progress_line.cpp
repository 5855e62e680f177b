#include "cli/progress_line.h"

#include <fmt/core.h>
#include <unistd.h>

namespace knotreel::cli {
namespace {

constexpr const char* kClearLine = "\r\x1b[K";

void put(const std::string& text) {
  // A line that cannot be shown is no reason to stop.
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

}  // namespace

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_) put(kClearLine);
}

void ProgressLine::show(const std::string& stage) {
  if (!terminal_) return;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
  put(fmt::format("{}knotreel: {} done after {:.1f} s", kClearLine, stage, passed.count()));
}

}  // namespace knotreel::cli
