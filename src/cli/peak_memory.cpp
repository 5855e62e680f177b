// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/peak_memory.h"

#include <fstream>
#include <limits>
#include <string>

namespace knotreel::cli {

std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    std::uint64_t kilobytes = 0;
    if (key == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

}  // namespace knotreel::cli
