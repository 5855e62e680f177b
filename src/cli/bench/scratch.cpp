// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/scratch.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>

#include "knotreel/base/error.h"

namespace knotreel::cli::bench {

Scratch::Scratch() {
  std::string pattern = (std::filesystem::temp_directory_path() / "knotreel-bench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw Error(ErrorKind::kOutput, "cannot make the folder '" + pattern + "': " + std::strerror(errno));
  }
  folder_ = pattern;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace knotreel::cli::bench
