#include "cli/batch/inputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "cli/pictures.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/natural_order.h"
#include "knotreel/image/format.h"

namespace knotreel::cli::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxListBytes = std::uint64_t{1} << 30;

/// A picture, and its place below the folder of the outputs.
struct Found {
  std::string input;
  fs::path place;
};

/// By content, else by name; what cannot be opened is taken by its name, so that it is told of.
bool looks_like_picture(const fs::path& path) {
  try {
    return is_picture(path);
  } catch (const Error&) {
    const std::string extension = path.extension().string();
    return !extension.empty() && image::format_of_extension(extension.substr(1)).has_value();
  }
}

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

template <class Iterator>
std::vector<std::string> pictures_below(const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> places;
  for (Iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if constexpr (requires { it.disable_recursion_pending(); }) {
      if (is_hidden(it->path()) && it->is_directory(ignored)) it.disable_recursion_pending();
    }
    if (is_hidden(it->path()) || !it->is_regular_file(ignored) || !looks_like_picture(it->path())) continue;
    places.push_back(it->path().lexically_relative(folder).string());
  }
  if (error) throw Error(ErrorKind::kInput, cannot_read(folder, "pictures") + error.message());
  std::sort(places.begin(), places.end(), natural_less);
  return places;
}

std::vector<Found> in_folder(const fs::path& folder, bool recursive) {
  const auto places = recursive ? pictures_below<fs::recursive_directory_iterator>(folder)
                                : pictures_below<fs::directory_iterator>(folder);
  std::vector<Found> found;
  for (const std::string& place : places) found.push_back({(folder / place).string(), place});
  return found;
}

std::vector<Found> in_list(const std::string& path) {
  if (path != "-" && fs::is_regular_file(path) && image::detect_format(read_start(path, 16))) {
    throw Error(ErrorKind::kInput,
                cannot_read(path, "list") + "it is a picture (see knotreel vectorize --help)");
  }
  const std::vector<std::byte> bytes = read_whole(path, kMaxListBytes, "list");
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::vector<Found> found;
  std::set<std::string> known;
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || !known.insert(line).second) continue;
    found.push_back({line, fs::path(line).filename()});
  }
  return found;
}

std::string with_number(fs::path place, int number) {
  if (number > 1) place += "-" + std::to_string(number);
  place += ".tcb";
  return place.string();
}

std::vector<std::string> names_of(const std::vector<Found>& found) {
  std::map<std::string, int> wanted;
  for (const Found& f : found) ++wanted[fs::path(f.place).replace_extension().string()];
  std::vector<std::string> names;
  std::set<std::string> taken;
  const auto take = [&](const fs::path& place) {
    for (int number = 1;; ++number) {
      if (taken.insert(with_number(place, number)).second) return with_number(place, number);
    }
  };
  // Names that nobody else wants are never taken away from their owners.
  for (const auto& [stem, count] : wanted) {
    if (count == 1) taken.insert(with_number(stem, 1));
  }
  for (const Found& f : found) {
    const fs::path stem = fs::path(f.place).replace_extension();
    names.push_back(wanted[stem.string()] == 1 ? with_number(stem, 1) : take(f.place));
  }
  return names;
}

}  // namespace

std::vector<Item> find_items(const Places& places) {
  std::error_code ignored;
  const bool folder = places.input != "-" && fs::is_directory(places.input, ignored);
  const std::vector<Found> found = folder ? in_folder(places.input, places.recursive) : in_list(places.input);
  if (found.empty()) throw Error(ErrorKind::kInput, cannot_read(places.input, "pictures") + "there are none");
  const std::vector<std::string> names = names_of(found);
  std::vector<Item> items;
  for (std::size_t i = 0; i < found.size(); ++i) {
    items.push_back({found[i].input, (fs::path(places.output) / names[i]).string()});
  }
  return items;
}

}  // namespace knotreel::cli::batch
