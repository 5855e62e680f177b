// SPDX-License-Identifier: GPL-3.0-or-later
#include "quiet.h"

#include <fcntl.h>
#include <unistd.h>

#include <mutex>

namespace knotreel::image {
namespace {
std::mutex mutex;
int nested = 0;
int saved = -1;  // a duplicate of the real standard error; -1 if it was closed
}  // namespace

QuietStandardError::QuietStandardError() {
  const std::lock_guard lock(mutex);
  if (nested++ > 0) return;
  saved = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (saved >= 0 && null >= 0) ::dup2(null, STDERR_FILENO);
  if (null >= 0) ::close(null);
}

QuietStandardError::~QuietStandardError() {
  const std::lock_guard lock(mutex);
  if (--nested > 0 || saved < 0) return;
  ::dup2(saved, STDERR_FILENO);
  ::close(saved);
  saved = -1;
}

}  // namespace knotreel::image
