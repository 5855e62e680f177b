// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/video/picture_list.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/natural_order.h"

namespace knotreel::video {
namespace fs = std::filesystem;

namespace {

/// The extension in lower case, with its dot.
std::string extension_of(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

bool is_picture_name(const std::string& name) {
  static const char* const kExtensions[] = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp",
                                            ".pbm", ".pgm", ".ppm",  ".pnm", ".pam",  ".pfm",  ".tga",
                                            ".dpx", ".exr", ".jp2",  ".sgi", ".gif"};
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension_of(name)) !=
         std::end(kExtensions);
}

bool has_wildcard(const std::string& name) {
  return name.find_first_of("*?[") != std::string::npos;
}

std::vector<std::string> names_in(const fs::path& folder, const std::string& input, const char* kind) {
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
       it.increment(error)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (!name.starts_with('.') && !it->is_directory(ignored)) names.push_back(name);
  }
  if (error) throw Error(ErrorKind::kInput, cannot_read(input, kind) + error.message());
  return names;
}

std::optional<std::uint64_t> number_in(const NumberPattern& pattern, const std::string& name) {
  const std::size_t around = pattern.before.size() + pattern.after.size();
  if (name.size() <= around || !name.starts_with(pattern.before) || !name.ends_with(pattern.after)) return {};
  const std::string digits = name.substr(pattern.before.size(), name.size() - around);
  if (digits.size() > 18 || digits.find_first_not_of("0123456789") != std::string::npos) return {};
  const std::uint64_t number = std::stoull(digits);
  // As printf would write it: so that %d does not take frame_0001 and frame_1 at once.
  if (pattern.name(number) != name) return {};
  return number;
}

std::vector<std::string> numbered(const std::vector<std::string>& names, const NumberPattern& pattern) {
  std::vector<std::pair<std::uint64_t, std::string>> found;
  for (const std::string& name : names) {
    if (const auto number = number_in(pattern, name)) found.emplace_back(*number, name);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> result;
  for (auto& [number, name] : found) result.push_back(std::move(name));
  return result;
}

}  // namespace

std::string NumberPattern::name(std::uint64_t number) const {
  std::string text = std::to_string(number);
  if (int(text.size()) < digits) text.insert(0, std::size_t(digits) - text.size(), '0');
  return before + text + after;
}

namespace {

/// @param pattern  of the first number. @returns how many numbers there are in the name of a file; -1 if a
/// `%` begins something else.
int take_apart(const std::string& path, NumberPattern& pattern) {
  const std::string name = fs::path(path).filename().string();
  int parts = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    std::string& side = parts == 0 ? pattern.before : pattern.after;
    if (name[i] != '%') {
      side += name[i];
    } else if (i + 1 < name.size() && name[i + 1] == '%') {
      side += name[++i];
    } else {
      std::size_t at = i + 1;
      const std::string width = digits_at(name, at);
      if (at >= name.size() || name[at] != 'd' || width.size() > 2) return -1;
      if (++parts == 1) pattern.digits = width.empty() ? 0 : std::stoi(width);
      i = at;
    }
  }
  return parts;
}

}  // namespace

std::optional<NumberPattern> number_pattern(const std::string& path) {
  NumberPattern pattern;
  if (take_apart(path, pattern) != 1) return {};
  return pattern;
}

bool has_several_numbers(const std::string& path) {
  NumberPattern ignored;
  return take_apart(path, ignored) > 1;
}

bool matches_pattern(const std::string& pattern, const std::string& name) {
  if (const auto numbers = number_pattern(pattern)) return number_in(*numbers, name).has_value();
  return ::fnmatch(fs::path(pattern).filename().c_str(), name.c_str(), 0) == 0;
}

bool means_pictures(const std::string& input) {
  std::error_code ignored;
  if (fs::is_directory(input, ignored)) return true;
  if (input == "-" || fs::exists(input, ignored) || input.find("://") != std::string::npos) return false;
  return number_pattern(input) || has_wildcard(fs::path(input).filename().string());
}

namespace {

/// @param kind  what `wanted` in a folder are, for messages.
template <class Wanted>
std::vector<std::string> list_files(const std::string& input, const char* kind, Wanted wanted) {
  std::error_code ignored;
  const bool folder = fs::is_directory(input, ignored);
  const fs::path where = folder ? fs::path(input) : fs::path(input).parent_path();
  std::vector<std::string> names = names_in(where, input, kind);
  if (const auto pattern = folder ? std::nullopt : number_pattern(input)) {
    names = numbered(names, *pattern);
  } else {
    std::erase_if(names, [&](const std::string& name) {
      return folder ? !wanted(name) : !matches_pattern(input, name);
    });
    std::sort(names.begin(), names.end(), natural_less);
  }
  if (names.empty()) throw Error(ErrorKind::kInput, cannot_read(input, kind) + "there are none");
  for (std::string& name : names) name = (where / name).string();
  return names;
}

}  // namespace

std::vector<std::string> list_pictures(const std::string& input) {
  return list_files(input, "pictures", is_picture_name);
}

std::vector<std::string> list_documents(const std::string& input) {
  return list_files(input, "documents", [](const std::string& name) { return extension_of(name) == ".tcb"; });
}

std::uint64_t missing_numbers(const std::string& input, const std::vector<std::string>& pictures) {
  const auto pattern = number_pattern(input);
  if (!pattern || pictures.empty()) return 0;
  const auto number = [&](const std::string& picture) {
    return number_in(*pattern, fs::path(picture).filename().string());
  };
  const auto first = number(pictures.front()), last = number(pictures.back());
  return first && last ? *last - *first + 1 - pictures.size() : 0;
}

}  // namespace knotreel::video
