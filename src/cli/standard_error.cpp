// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/standard_error.h"

#include <fcntl.h>
#include <unistd.h>

#include "cli/printable.h"

namespace knotreel::cli {
namespace {

int kept_stream = -1;  // nothing is written if standard error was closed: its number may be that of a file

}  // namespace

void keep_standard_error() {
  kept_stream = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
}

bool standard_error_is_terminal() {
  return ::isatty(kept_stream) == 1;
}

void put_error(const std::string& text) {
  [[maybe_unused]] const ssize_t ignored = ::write(kept_stream, text.data(), text.size());
}

void put_error_line(const std::string& message) {
  put_error("knotreel: " + printable(message) + "\n");
}

}  // namespace knotreel::cli
