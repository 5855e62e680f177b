// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/split_folder.h"

#include <filesystem>
#include <system_error>

#include "knotreel/base/error.h"

namespace knotreel::pipeline {

void make_split_folder(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error(ErrorKind::kOutput, "cannot make the folder '" + folder + "': " + error.message());
  }
}

std::string single_path(const std::string& folder, std::uint64_t index) {
  std::string number = std::to_string(index + 1);
  if (number.size() < 6) number.insert(0, 6 - number.size(), '0');
  return (std::filesystem::path(folder) / ("frame_" + number + ".tcb")).string();
}

}  // namespace knotreel::pipeline
