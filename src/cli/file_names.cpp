// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/file_names.h"

#include <set>

#include "cli/command.h"
#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return extension;
}

}  // namespace

std::string quoted(const std::string& path, const char* dash) {
  return path == "-" ? dash : "'" + path + "'";
}

bool has_picture_name(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return !extension.empty() && image::format_of_extension(extension.substr(1)).has_value();
}

bool has_clip_name(const std::filesystem::path& path) {
  static const std::set<std::string> kExtensions{
      ".3gp", ".apng", ".asf", ".avi", ".f4v", ".flv",   ".gif",  ".h264", ".h265", ".hevc",
      ".ivf", ".m2ts", ".m4v", ".mkv", ".m2v", ".mjpeg", ".mjpg", ".mov",  ".mp4",  ".mpeg",
      ".mpg", ".mts",  ".mxf", ".nut", ".ogv", ".ts",    ".vob",  ".webm", ".wmv",  ".y4m"};
  return kExtensions.contains(lower_extension(path));
}

std::string drawing_format(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".svg" || extension == ".pdf" ? extension.substr(1) : "";
}

void check_document_name(const std::string& name) {
  const bool drawing = !drawing_format(name).empty();
  if (!drawing && !has_picture_name(name) && !has_clip_name(name)) return;
  const char* command = drawing ? "export" : "render";
  throw Error(ErrorKind::kInvalidArgument, "'" + name +
                                               "' is no name for a vector document, such as x.tcb; '" +
                                               command + " x.tcb -o " + name + "' makes the other from one");
}

void warn_of_numbered_document(const std::string& name) {
  if (video::number_pattern(name))
    warn("'" + name + "' is one document with all frames; --split DIR writes one for each");
}

void check_rendering_name(const std::string& name, const std::string& document_command) {
  const bool document = lower_extension(name) == ".tcb";
  if (!document && drawing_format(name).empty()) return;
  throw Error(ErrorKind::kInvalidArgument, "'" + name + "' is no name for a picture or a video; 'knotreel " +
                                               (document ? document_command + " FILE" : "export FILE.tcb") +
                                               " -o " + name + "' writes such a file");
}

}  // namespace knotreel::cli
