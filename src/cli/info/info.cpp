// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <memory>

#include "cli/command.h"
#include "cli/frame_source.h"
#include "cli/info/facts.h"
#include "cli/pictures.h"
#include "cli/printable.h"
#include "cli/standard_input.h"
#include "cli/video_run.h"
#include "knotreel/image/read_image.h"

namespace knotreel::cli {

std::string channels_name(int channels) {
  static constexpr const char* kNames[] = {"grey", "grey + alpha", "RGB", "RGBA"};
  return channels >= 1 && channels <= 4 ? kNames[channels - 1] : "unknown";
}

namespace {

Facts picture_facts(const std::string& path) {
  image::ImageFileInfo file;
  const image::Image image = image::read_image(path, &file);
  static constexpr const char* kDepths[] = {"8", "16", "float"};
  return {{"kind", "picture"},
          {"format", image::format_name(file.format)},
          {"width", image.width},
          {"height", image.height},
          {"channels", image.channels},
          {"depth", kDepths[static_cast<int>(file.samples)]},
          {"file_bytes", file.file_bytes}};
}

std::string picture_text(const std::string& path, const Facts& facts) {
  return fmt::format(
      "{}: {} picture\n"
      "size            {}x{}, {}, {} per sample\n"
      "file            {} bytes\n",
      path, facts["format"].get<std::string>(), facts["width"].get<int>(), facts["height"].get<int>(),
      channels_name(facts["channels"].get<int>()),
      facts["depth"] == "float" ? "float" : facts["depth"].get<std::string>() + " bits",
      facts["file_bytes"].get<std::uint64_t>());
}

/// With no control character in any text: not all that files say of themselves is well meant.
Facts printable_facts(const Facts& facts) {
  if (facts.is_string()) return printable(facts.get<std::string>());
  if (facts.is_array()) {
    Facts all = Facts::array();
    for (const Facts& part : facts) all.push_back(printable_facts(part));
    return all;
  }
  if (!facts.is_object()) return facts;
  Facts all = Facts::object();
  for (const auto& [name, part] : facts.items()) all[printable(name)] = printable_facts(part);
  return all;
}

bool tells_of_video(const std::string& path) {
  return !path.ends_with(".tcb") && is_video(path, {});
}

void print_info(const std::string& path, bool json) {
  const auto tell = [&](const Facts& facts, std::string (*text)(const std::string&, const Facts&)) {
    write_text("-", json ? facts.dump(2, ' ', false, Facts::error_handler_t::replace) + "\n"
                         : text(printable(path), printable_facts(facts)));
  };
  const bool document = is_document(path);
  if (!document && tells_of_video(path)) {
    tell(video_facts(path), video_text);
  } else if (!document && is_picture(path)) {
    tell(picture_facts(path), picture_text);
  } else {  // also what is of none of the kinds, to be refused
    tell(document_facts(path), document_text);
  }
}

}  // namespace

void add_info_command(CLI::App& program) {
  struct Arguments {
    std::string input;
    bool json = false;
  };
  CLI::App* command =
      program.add_subcommand("info", "Tell what is in a vector document, a picture or a video");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->input, "Vector document, picture or video; '-': standard input")
      ->type_name("")
      ->required();
  command->add_flag("--json", arguments->json, "Print as JSON, with a list of all frames of a document");
  command->footer(
      "\nAll frames are read, so a document that is told about without an error is sound. In JSON, knots "
      "and\n"
      "control points are sums over the frames. A truncated document is read up to its last whole frame. Of\n"
      "a video the first frame is decoded; number of frames and length are as the file tells.\n"
      "Examples:\n  knotreel info photo.tcb\n  knotreel info clip.tcb --json\n  knotreel info clip.mp4");
  command->callback([arguments] { print_info(pipe_as_standard_input(arguments->input), arguments->json); });
}

}  // namespace knotreel::cli
