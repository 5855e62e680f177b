// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/manifest.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli::batch {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxManifestBytes = std::uint64_t{1} << 32;

/// JSON has no infinity: null stands for it where there are figures.
Json json_of(const Entry& entry) {
  Json json{{"input", entry.item.input}, {"output", entry.item.output}, {"status", entry.status}};
  json["error"] = entry.error.empty() ? Json(nullptr) : Json(entry.error);
  for (const char* key : {"knots", "control_points", "psnr", "file_bytes", "frames"}) json[key] = nullptr;
  if (entry.figures) {
    json["knots"] = entry.figures->knots;
    json["control_points"] = entry.figures->control_points;
    if (std::isfinite(entry.figures->psnr)) json["psnr"] = entry.figures->psnr;
    json["file_bytes"] = entry.figures->file_bytes;
    json["frames"] = entry.figures->frames;
  }
  json["seconds"] = std::round(entry.seconds * 1000) / 1000;
  json["input_size"] = entry.stamp ? Json(entry.stamp->size) : Json(nullptr);
  json["input_mtime"] = entry.stamp ? Json(entry.stamp->mtime) : Json(nullptr);
  if (entry.stamp && entry.stamp->files) json["input_files"] = *entry.stamp->files;
  return json;
}

/// @throws nlohmann's exceptions if a member is missing or of another type.
Entry entry_of(const Json& json) {
  Entry entry{{json.at("input"), json.at("output")}, json.at("status"), {}, {}, {}, json.at("seconds")};
  if (!json.at("error").is_null()) entry.error = json.at("error");
  if (!json.at("knots").is_null()) {
    const Json& psnr = json.at("psnr");
    const double db = psnr.is_null() ? std::numeric_limits<double>::infinity() : psnr.get<double>();
    entry.figures =
        Figures{json.at("knots"), json.at("control_points"), db, json.at("file_bytes"), json.at("frames")};
  }
  if (!json.at("input_size").is_null()) {
    entry.stamp = Stamp{json.at("input_size"), json.at("input_mtime"), {}};
    if (json.contains("input_files")) entry.stamp->files = json["input_files"].get<std::uint64_t>();
  }
  return entry;
}

bool lacks_line_end(int descriptor) {
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  char last = '\n';
  return size > 0 && ::pread(descriptor, &last, 1, size - 1) == 1 && last != '\n';
}

[[noreturn]] void fail(const std::string& path) {
  throw Error(ErrorKind::kOutput,
              "cannot write manifest '" + path + "': " + std::generic_category().message(errno));
}

int open_manifest(const std::string& path, bool keep) {
  if (path == "-") return ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | (keep ? 0 : O_TRUNC), 0666);
}

std::optional<Stamp> stamp_of_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  const std::int64_t second = 1'000'000'000;
  return Stamp{std::uint64_t(status.st_size), status.st_mtim.tv_sec * second + status.st_mtim.tv_nsec, {}};
}

/// Of a folder or a pattern: pictures may change without the folder, and a pattern is no file.
std::optional<Stamp> stamp_of_pictures(const std::string& input) try {
  const std::vector<std::string> pictures = video::list_pictures(input);
  Stamp all;
  all.files = pictures.size();
  for (const std::string& picture : pictures) {
    const std::optional<Stamp> stamp = stamp_of_file(picture);
    if (!stamp) return std::nullopt;
    all.size += stamp->size;
    all.mtime = std::max(all.mtime, stamp->mtime);
  }
  return all;
} catch (const Error&) {
  return std::nullopt;  // there are none, which whoever reads them tells
}

}  // namespace

std::optional<Stamp> stamp_of(const std::string& path) {
  return video::means_pictures(path) ? stamp_of_pictures(path) : stamp_of_file(path);
}

std::map<std::string, Entry> read_manifest(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  const std::vector<std::byte> bytes = read_whole(path, kMaxManifestBytes, "manifest");
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::map<std::string, Entry> entries;
  for (std::string line; std::getline(lines, line);) {
    try {
      Entry entry = entry_of(Json::parse(line));
      entries[entry.item.input] = std::move(entry);
    } catch (const Json::exception&) {
      continue;
    }
  }
  return entries;
}

Manifest::Manifest(std::string path, bool keep) : Manifest(std::move(path)) {
  descriptor_ = open_manifest(path_, keep);
  if (descriptor_ < 0) fail(path_);
  // A kill may have cut the last line.
  if (lacks_line_end(descriptor_)) write("\n");
}

Manifest::~Manifest() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Manifest::add(const Entry& entry) {
  const std::string line = json_of(entry).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  write(line);
}

void Manifest::write(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t put = ::write(descriptor_, text.data() + done, text.size() - done);
    if (put < 0 && errno != EINTR) fail(path_);
    if (put > 0) done += std::size_t(put);
  }
}

}  // namespace knotreel::cli::batch
