#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "knotreel/document/reader.h"
#include "knotreel/image/read_image.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* channels_name(int channels) {
  static constexpr const char* kNames[] = {"grey", "grey + alpha", "RGB", "RGBA"};
  return channels >= 1 && channels <= 4 ? kNames[channels - 1] : "unknown";
}

Json picture_info(const std::string& path) {
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

/// Reads every frame, so a document of which this tells is sound.
Json document_info(const std::string& path) {
  document::Reader reader = document::Reader::open(path);
  const document::SequenceInfo& info = reader.info();
  Json frames = Json::array();
  std::uint64_t knots = 0;
  std::uint64_t control_points = 0;
  std::uint64_t raw_bytes = 0;
  for (std::size_t i = 0; i < reader.frame_count(); ++i) {
    check_interrupted();
    const document::FrameModel model = reader.read(i);
    const auto record = reader.record(i);
    const auto& space = *model.space;
    const std::uint64_t frame_raw_bytes = document::raw_accounting_bytes(model);
    knots += space.mesh().knots.size();
    control_points += space.function_count();
    raw_bytes += frame_raw_bytes;
    frames.push_back({{"frame", i},
                      {"pts", record.pts},
                      {"keyframe", record.keyframe},
                      {"bytes", record.bytes},
                      {"knots", space.mesh().knots.size()},
                      {"triangles", space.mesh().faces.size()},
                      {"feature_segments", space.mesh().segments.size()},
                      {"control_points", space.function_count()},
                      {"raw_accounting_bytes", frame_raw_bytes}});
  }
  return {{"kind", "document"},
          {"width", info.width},
          {"height", info.height},
          {"channels", info.channels},
          {"degree", info.degree},
          {"time_base", {info.time_base_num, info.time_base_den}},
          {"complete", reader.complete()},
          {"file_bytes", reader.file_bytes()},
          {"raw_accounting_bytes", raw_bytes},
          {"knots", knots},
          {"control_points", control_points},
          {"metadata", info.metadata},
          {"frames", std::move(frames)}};
}

std::string picture_text(const std::string& path, const Json& info) {
  return fmt::format(
      "{}: {} picture\n"
      "size            {}x{}, {}, {} per sample\n"
      "file            {} bytes\n",
      path, info["format"].get<std::string>(), info["width"].get<int>(), info["height"].get<int>(),
      channels_name(info["channels"].get<int>()),
      info["depth"] == "float" ? "float" : info["depth"].get<std::string>() + " bits",
      info["file_bytes"].get<std::uint64_t>());
}

std::string document_text(const std::string& path, const Json& info) {
  const std::size_t frames = info["frames"].size();
  std::uint64_t keyframes = 0;
  for (const Json& frame : info["frames"]) keyframes += frame["keyframe"].get<bool>() ? 1 : 0;
  std::string text = fmt::format(
      "{}: knotreel vector document\n"
      "size            {}x{}, {}\n"
      "frames          {} ({} keyframes), time base {}/{} s\n"
      "state           {}\n"
      "degree          {}\n"
      "knots           {}\n"
      "control points  {}\n"
      "raw accounting  {} bytes (20 per control point, 8 per knot, 6 per triangle)\n"
      "file            {} bytes\n",
      path, info["width"].get<int>(), info["height"].get<int>(), channels_name(info["channels"].get<int>()),
      frames, keyframes, info["time_base"][0].get<std::int64_t>(), info["time_base"][1].get<std::int64_t>(),
      info["complete"].get<bool>() ? "complete" : "truncated: read up to the last whole frame",
      info["degree"].get<int>(), info["knots"].get<std::uint64_t>(),
      info["control_points"].get<std::uint64_t>(), info["raw_accounting_bytes"].get<std::uint64_t>(),
      info["file_bytes"].get<std::uint64_t>());
  for (const auto& [key, value] : info["metadata"].items()) {
    text += fmt::format("{:<15} {}\n", key, value.get<std::string>());
  }
  return text;
}

void print_info(const std::string& path, bool json) {
  const bool picture = is_picture(path);
  const Json info = picture ? picture_info(path) : document_info(path);
  if (json) {
    write_text("-", info.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else {
    write_text("-", picture ? picture_text(path, info) : document_text(path, info));
  }
}

}  // namespace

void add_info_command(CLI::App& program) {
  struct Arguments {
    std::string input;
    bool json = false;
  };
  CLI::App* command = program.add_subcommand("info", "Tell what is in a vector document or a picture");
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("FILE", arguments->input, "Vector document or picture; '-': a picture from standard input")
      ->type_name("")
      ->required();
  command->add_flag("--json", arguments->json, "Print as JSON, with a list of all frames");
  command->footer(
      "\nAll frames are read, so a document that is told about without an error is sound. Knots and control\n"
      "points are summed over the frames. A truncated document is read up to its last whole frame.\n"
      "Examples:\n  knotreel info photo.tcb\n  knotreel info photo.tcb --json");
  command->callback([arguments] { print_info(arguments->input, arguments->json); });
}

}  // namespace knotreel::cli
