// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/document_part.h"
#include "cli/drawing_file.h"
#include "cli/file_names.h"
#include "cli/part_options.h"
#include "cli/pictures.h"
#include "cli/video_options.h"
#include "cli/video_report.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli {
namespace {

constexpr std::size_t kAtOnce = 16;  // frames of a sequence

struct ExportArguments {
  std::string input;
  std::string output;
  std::string format;
  std::uint64_t frame = 0;
  PartOptions part;  ///< of which there is a numbered picture each
  double scale = 1;
  std::optional<double> colour_tolerance;
  double geometry_tolerance = 0.1;
  std::uint64_t max_triangles = 4'000'000;
  int threads = 0;
};

/// "pdf" or "svg", from --format or the name of the output.
std::string format_of(const ExportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format;
  const std::string format = drawing_format(arguments.output);
  if (!format.empty()) return format;
  throw Error(ErrorKind::kInvalidArgument,
              "export writes pdf and svg; name the output so or give --format: '" + arguments.output + "'");
}

exporting::ExportOptions options_of(const ExportArguments& arguments, const std::string& format) {
  exporting::ExportOptions options = drawing_options(format);
  options.scale = arguments.scale;
  if (arguments.colour_tolerance) options.tessellation.colour_tolerance = *arguments.colour_tolerance;
  options.tessellation.geometry_tolerance = arguments.geometry_tolerance;
  options.max_triangles = arguments.max_triangles;
  return options;
}

/// @returns the size of the file in bytes.
std::uint64_t write_frame(const document::FrameModel& model, const exporting::ExportOptions& options,
                          const std::string& format, const std::filesystem::path& path) {
  OutputFile file(path);
  write_drawing(model, options, format, file);
  file.commit();
  return file.size();
}

void export_one(const ExportArguments& arguments, document::Reader& reader,
                const exporting::ExportOptions& options, const std::string& format) {
  warn_if_large(write_frame(read_frame(reader, arguments.frame), options, format, arguments.output), format);
}

/// Frames are read in turn, since most are changes to the one before, and written several at once.
void export_all(const ExportArguments& arguments, document::Reader& reader,
                const exporting::ExportOptions& options, const std::string& format,
                const video::NumberPattern& names) {
  const FrameRange range = frames_of(reader, part_of(arguments.part));
  const std::size_t count = frames_in(range, reader);
  VideoLine line(count);
  const std::filesystem::path folder = std::filesystem::path(arguments.output).parent_path();
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t largest = 0;
  for (std::size_t done = 0; done < count;) {
    std::vector<document::FrameModel> models;
    while (models.size() < kAtOnce && done + models.size() < count) {
      models.push_back(read_frame(reader, range.first + done + models.size()));
    }
    std::vector<std::uint64_t> bytes(models.size());
    parallel_for(models.size(), [&](std::size_t i) {
      bytes[i] = write_frame(models[i], options, format, folder / names.name(done + i + 1));
    });
    largest = std::max(largest, *std::max_element(bytes.begin(), bytes.end()));
    done += models.size();
    pipeline::FrameRow row;
    row.index = done - 1;
    row.knots = models.back().space->mesh().knots.size();
    row.finished_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    line.show(row);
  }
  warn_if_large(largest, format);
}

/// Options that would be without effect are refused: a picture of another frame looks right.
void check_kind(const CLI::App& command, bool several) {
  if (several && command.count("--frame") > 0) {
    throw Error(ErrorKind::kInvalidArgument,
                "--frame is for one picture; use --frames for a numbered one each");
  }
  for (const std::string& name : options_given(command, kVideoGroup)) {
    if (several) break;
    throw Error(ErrorKind::kInvalidArgument,
                name + " is for numbered pictures, such as frame_%04d.svg; use --frame for one");
  }
}

void run_export(const CLI::App& command, const ExportArguments& arguments) {
  const Output output = video_output(arguments.output);
  const std::optional<video::NumberPattern> names = video::number_pattern(arguments.output);
  check_kind(command, names.has_value());
  check_paths({arguments.input}, {output});
  const ThreadCap cap(arguments.threads);
  const std::string format = format_of(arguments);
  exporting::ExportOptions options = options_of(arguments, format);
  exporting::check_options(options);
  part_of(arguments.part);
  document::Reader reader = open_document(arguments.input);
  options.turn = turn_of(reader);
  if (names) {
    export_all(arguments, reader, options, format, *names);
  } else {
    warn_of_other_frames(arguments.input, reader, command.count("--frame") > 0);
    export_one(arguments, reader, options, format);
  }
}

constexpr const char* kExportFooter = R"(
PDF keeps the smooth shading; poppler and MuPDF were tried. SVG has no such shading: there a picture becomes
regions of one colour or one linear gradient each, whose outlines are curves. Drawings take few of them.
Examples:
  knotreel export photo.tcb -o photo.pdf
  knotreel export photo.tcb -o poster.pdf --scale 4 --colour-tolerance 1
  knotreel export photo.tcb -o small.svg --colour-tolerance 12
  knotreel export clip.tcb -o frame_%04d.svg --frames 0-24)";

}  // namespace

void add_export_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("export", "Write frames of a vector document as PDF or SVG, for other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("FILE", arguments->input, "Vector document (.tcb); '-': standard input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "File to write; its name says the format: pdf or svg. frame_%04d.svg means\n"
                   "one per frame. '-': standard output")
      ->type_name("FILE")
      ->required();
  add_frame_option(*command, arguments->frame, "Frame of a sequence, counted from 0");
  command
      ->add_option("--scale", arguments->scale,
                   "Size of a picture pixel on the page, in points (PDF) or user units\n(SVG), 0.001 to 1000")
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option(
          "--colour-tolerance", arguments->colour_tolerance,
          "Largest error of a colour, in levels of 0 to 255; 0.01 to 255.\nWithout: 2 for PDF, 6 for SVG")
      ->type_name("T");
  command
      ->add_option("--geometry-tolerance", arguments->geometry_tolerance,
                   "Largest error of a position, in picture pixels; 0.001 to 100")
      ->type_name("G")
      ->capture_default_str();
  command
      ->add_option("--max-triangles", arguments->max_triangles,
                   "Give up above so many triangles, up to 1000000000")
      ->check(CLI::Range(1, 1'000'000'000).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--format", arguments->format, "Format if the name does not say it: pdf or svg")
      ->check(CLI::IsMember({"pdf", "svg"}).description(""))
      ->type_name("NAME");
  add_threads_option(*command, arguments->threads);
  add_no_overwrite_option(*command);
  add_quiet_option(*command);
  command->option_defaults()->group(kVideoGroup);
  add_part_options(*command, arguments->part, "Only these frames, counted from 0; A- is up to the end");
  command->option_defaults()->group("Options");
  command->footer(kExportFooter);
  command->callback([command, arguments] { run_export(*command, *arguments); });
}

}  // namespace knotreel::cli
