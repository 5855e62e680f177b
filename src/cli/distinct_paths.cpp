// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/distinct_paths.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "cli/file_names.h"
#include "knotreel/base/error.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli {
namespace {

namespace fs = std::filesystem;

/// Of files, by what makes them the same; the values are their names as given.
using Names = std::map<std::string, std::string>;

bool keeps_files = false;  // set before commands run, and not changed any more

/// Where a path leads, without links in it as far as it exists.
std::string place_of(const fs::path& path) {
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return (place.empty() ? path : place).string();
}

bool exists(const std::string& path, int standard_stream, struct stat& status) {
  return path == "-" ? ::fstat(standard_stream, &status) == 0 : ::stat(path.c_str(), &status) == 0;
}

/// The same for all names of a file that is there; empty for what is no regular file.
std::string identity_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) return {};
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

/// All pictures, or the path itself if it does not mean several.
std::vector<std::string> files_of(const std::string& path) {
  try {
    return video::list_pictures(path);
  } catch (const Error&) {
    return {};  // there are none; who reads them will tell
  }
}

void add_input(const std::string& path, Names& names) {
  struct stat status {};
  if (path.empty() || !exists(path, STDIN_FILENO, status)) return;
  const std::string identity = identity_of(status);
  if (!identity.empty()) names.emplace(identity, path);
}

Names names_of(const std::vector<std::string>& inputs) {
  Names names;
  for (const std::string& input : inputs) {
    if (video::means_pictures(input)) {
      for (const std::string& file : files_of(input)) add_input(file, names);
    } else {
      // libav takes both for the same.
      add_input(input.starts_with("file://") ? input.substr(5) : input, names);
    }
  }
  return names;
}

[[noreturn]] void refuse_path(const std::string& what, const std::string& same_as) {
  throw Error(ErrorKind::kInvalidArgument, "output " + what + " is the same file as " + same_as);
}

/// The outputs so far.
class Written {
 public:
  explicit Written(Names inputs) : inputs_(std::move(inputs)) {}

  void add(const Output& output) {
    if (output.path.empty()) return;
    if (!output.pattern) {
      add_file(output.path, output.path);
      return;
    }
    claim(place_of(output.path), output.path, output.path);
    for (const std::string& file : files_of(output.path)) add_file(file, output.path);
  }

 private:
  void add_file(const std::string& file, const std::string& name) {
    struct stat status {};
    claim(exists(file, STDOUT_FILENO, status) ? identity_of(status) : place_of(file), file, name);
  }

  void claim(const std::string& identity, const std::string& file, const std::string& name) {
    if (identity.empty()) return;
    const std::string what = quoted(file, "standard output");
    if (const auto input = inputs_.find(identity); input != inputs_.end()) {
      refuse_path(what, "input " + quoted(input->second, "standard input"));
    }
    const auto [other, is_new] = outputs_.emplace(identity, name);
    if (!is_new) refuse_path(what, "output " + quoted(other->second, "standard output"));
  }

  Names inputs_;
  Names outputs_;
};

/// Files that are not there yet.
void check_pattern(const Output& pattern, const std::vector<Output>& outputs) {
  const fs::path place = place_of(pattern.path);
  for (const Output& output : outputs) {
    if (output.pattern || output.path.empty() || output.path == "-") continue;
    const fs::path other = place_of(output.path);
    if (other.parent_path() == place.parent_path() &&
        video::matches_pattern(pattern.path, other.filename().string())) {
      refuse_path(quoted(output.path, ""), "one of output " + quoted(pattern.path, ""));
    }
  }
}

/// What standard output leads to is for the shell to say; devices and pipes are there to be written to.
void check_new(const Output& output) {
  if (output.path.empty() || output.path == "-") return;
  for (const std::string& file : output.pattern ? files_of(output.path) : std::vector{output.path}) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    throw Error(ErrorKind::kOutput, quoted(file, "") + " is there already, and --no-overwrite was given");
  }
}

}  // namespace

Output video_output(const std::string& path, const std::string& container) {
  if (container == "null" || container == "hash") return {};
  if (container.empty() && video::has_several_numbers(path)) {
    throw Error(ErrorKind::kInvalidArgument, quoted(path, "") +
                                                 " has more than one number; numbered outputs have one, as "
                                                 "frame_%04d.png has (%% is a % of the name itself)");
  }
  return {path, container.empty() && video::number_pattern(path).has_value()};
}

Output split_output(const std::string& folder) {
  if (folder.empty()) return {};
  return {(fs::path(folder) / "frame_%06d.tcb").string(), true};
}

void add_split_option(CLI::App& command, std::string& folder) {
  command
      .add_option("--split", folder,
                  "Write a document per frame, frame_000001.tcb and so on, into this\n"
                  "folder, made if missing; then --output may be left out")
      ->type_name("DIR");
}

void add_no_overwrite_option(CLI::App& command) {
  command.add_flag_callback(
      "-n,--no-overwrite", [] { keeps_files = true; },
      "Replace no file: end with code 4 if an output is there already");
}

void check_paths(const std::vector<std::string>& inputs, const std::vector<Output>& outputs) {
  const auto is_dash = [](const Output& output) { return output.path == "-"; };
  if (std::count_if(outputs.begin(), outputs.end(), is_dash) > 1) {
    throw Error(ErrorKind::kInvalidArgument, "only one output can be standard output");
  }
  Written written(names_of(inputs));
  for (const Output& output : outputs) {
    written.add(output);
    if (output.pattern) check_pattern(output, outputs);
  }
  if (keeps_files) std::for_each(outputs.begin(), outputs.end(), check_new);
}

bool uses_standard_output(const std::vector<Output>& outputs) {
  return std::any_of(outputs.begin(), outputs.end(), [](const Output& o) { return o.path == "-"; });
}

}  // namespace knotreel::cli
