// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/inputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "cli/file_names.h"
#include "cli/pictures.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/natural_order.h"
#include "knotreel/image/format.h"

namespace knotreel::cli::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxListBytes = std::uint64_t{1} << 30;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  ///< that some editors begin text with

/// An input, and its place below the folder of the outputs.
struct Found {
  std::string input;
  fs::path place;
};

/// By content, else by name; what cannot be opened is taken by its name, so that it is told of.
bool looks_like_picture(const fs::path& path) {
  try {
    return is_picture(path);
  } catch (const Error&) {
    return has_picture_name(path);
  }
}

/// By the name alone: nearly any file can be tried as a video, and that takes long. But for pictures that
/// move.
bool looks_like_clip(const fs::path& path) {
  return has_clip_name(path) || (has_picture_name(path) && !looks_like_picture(path));
}

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

/// Files, and links that lead nowhere: whoever reads those tells of them.
bool may_be_input(const fs::directory_entry& entry) {
  std::error_code ignored;
  const fs::file_status status = entry.status(ignored);
  return fs::is_regular_file(status) || (entry.is_symlink(ignored) && !fs::exists(status));
}

template <class Iterator>
std::vector<std::string> inputs_below(const fs::path& folder, bool clips_only) {
  std::error_code error;
  std::vector<std::string> places;
  for (Iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if constexpr (requires { it.disable_recursion_pending(); }) {
      if (is_hidden(it->path()) && it->is_directory(ignored)) it.disable_recursion_pending();
    }
    if (is_hidden(it->path()) || !may_be_input(*it)) continue;
    const bool picture = !clips_only && looks_like_picture(it->path());
    if (!picture && !looks_like_clip(it->path())) continue;
    places.push_back(it->path().lexically_relative(folder).string());
  }
  if (error) throw Error(ErrorKind::kInput, cannot_read(folder, "pictures") + error.message());
  std::sort(places.begin(), places.end(), natural_less);
  return places;
}

std::vector<Found> in_folder(const fs::path& folder, const Places& wanted) {
  const bool clips_only = wanted.clips_only;
  const auto places = wanted.recursive ? inputs_below<fs::recursive_directory_iterator>(folder, clips_only)
                                       : inputs_below<fs::directory_iterator>(folder, clips_only);
  std::vector<Found> found;
  for (const std::string& place : places) found.push_back({(folder / place).string(), place});
  return found;
}

/// What somebody may take for an input, and is not one.
void check_list(const std::string& path) {
  if (path == "-" || !fs::is_regular_file(path)) return;
  const bool picture = image::detect_format(read_start(path, 16)).has_value();
  if (!picture && !looks_like_clip(path)) return;
  throw Error(ErrorKind::kInput, cannot_read(path, "list") + "it is a " + (picture ? "picture" : "video") +
                                     " (see knotreel vectorize --help)");
}

std::vector<Found> in_list(const std::string& path) {
  check_list(path);
  const std::vector<std::byte> bytes = read_whole(path, kMaxListBytes, "list");
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  if (text.find('\0') != std::string::npos) {
    throw Error(ErrorKind::kInput, cannot_read(path, "list") + "it is not text with one path per line");
  }
  std::istringstream lines(text);
  std::vector<Found> found;
  std::set<std::string> known;
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || !known.insert(fs::path(line).lexically_normal().string()).second) continue;
    found.push_back({line, fs::path(line).filename()});
  }
  return found;
}

std::string with_number(fs::path place, int number, const std::string& extension) {
  if (number > 1) place += "-" + std::to_string(number);
  place += extension;
  return place.string();
}

std::vector<std::string> names_of(const std::vector<Found>& found, const std::string& extension) {
  std::map<std::string, int> wanted;
  for (const Found& f : found) ++wanted[fs::path(f.place).replace_extension().string()];
  std::vector<std::string> names;
  std::set<std::string> taken;
  const auto take = [&](const fs::path& place) {
    for (int number = 1;; ++number) {
      if (taken.insert(with_number(place, number, extension)).second)
        return with_number(place, number, extension);
    }
  };
  // Names that nobody else wants are never taken away from their owners.
  for (const auto& [stem, count] : wanted) {
    if (count == 1) taken.insert(with_number(stem, 1, extension));
  }
  for (const Found& f : found) {
    const fs::path stem = fs::path(f.place).replace_extension();
    names.push_back(wanted[stem.string()] == 1 ? with_number(stem, 1, extension) : take(f.place));
  }
  return names;
}

}  // namespace

std::vector<Item> find_items(const Places& places) {
  std::error_code ignored;
  const bool folder = places.input != "-" && fs::is_directory(places.input, ignored);
  const std::vector<Found> found = folder ? in_folder(places.input, places) : in_list(places.input);
  if (found.empty())
    throw Error(
        ErrorKind::kInput,
        cannot_read(places.input, places.clips_only ? "videos" : "pictures or videos") + "there are none");
  const std::vector<std::string> names = names_of(found, places.extension);
  std::vector<Item> items;
  for (std::size_t i = 0; i < found.size(); ++i) {
    items.push_back({found[i].input, (fs::path(places.output) / names[i]).string()});
  }
  return items;
}

}  // namespace knotreel::cli::batch
