#include <filesystem>
#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/export/pdf.h"
#include "knotreel/export/svg.h"

namespace knotreel::cli {
namespace {

// Above this, programs that show SVG become slow.
constexpr std::uint64_t kLargeSvgBytes = 20'000'000;
// Default colour tolerances: hardly to be told from the surface; and what keeps SVG at some megabytes.
constexpr double kPdfTolerance = 2;
constexpr double kSvgTolerance = 8;

struct ExportArguments {
  std::string input;
  std::string output;
  std::string format;
  std::uint64_t frame = 0;
  double scale = 1;
  std::optional<double> colour_tolerance;
  double geometry_tolerance = 0.1;
  std::uint64_t max_triangles = 4'000'000;
  int threads = 0;
};

/// "pdf" or "svg", from --format or the name of the output.
std::string format_of(const ExportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format;
  std::string extension = std::filesystem::path(arguments.output).extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  if (extension == ".pdf" || extension == ".svg") return extension.substr(1);
  throw Error(ErrorKind::kInvalidArgument,
              "export writes pdf and svg; name the output so or give --format: '" + arguments.output + "'");
}

void export_frame(const ExportArguments& arguments) {
  check_paths({arguments.input}, {{arguments.output}});
  const ThreadCap cap(arguments.threads);
  const std::string format = format_of(arguments);
  exporting::ExportOptions options;
  options.scale = arguments.scale;
  options.tessellation.colour_tolerance =
      arguments.colour_tolerance.value_or(format == "pdf" ? kPdfTolerance : kSvgTolerance);
  options.tessellation.geometry_tolerance = arguments.geometry_tolerance;
  options.max_triangles = arguments.max_triangles;
  options.checkpoint = check_interrupted;

  document::Reader reader = open_document(arguments.input);
  const document::FrameModel model = read_frame(reader, arguments.frame);
  options.turn = turn_of(reader);
  OutputFile file(arguments.output);
  if (format == "pdf") {
    write_pdf(model, options, file);
  } else {
    write_svg(model, options, file);
  }
  file.commit();
  if (format == "svg" && file.size() > kLargeSvgBytes) {
    warn("the SVG has " + std::to_string(file.size() / 1'000'000) +
         " MB, which many programs show slowly; a larger --colour-tolerance makes it smaller, PDF much "
         "smaller");
  }
}

constexpr const char* kExportFooter = R"(
PDF keeps the smooth shading; poppler and MuPDF were tried. SVG has no such shading: a picture becomes many
small pieces, and at equal tolerance the file is about a hundred times as large.
Examples:
  knotreel export photo.tcb -o photo.pdf
  knotreel export photo.tcb -o poster.pdf --scale 4 --colour-tolerance 1
  knotreel export photo.tcb -o small.svg --colour-tolerance 16)";

}  // namespace

void add_export_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "export", "Write a frame of a vector document as PDF or SVG, for other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("FILE", arguments->input, "Vector document (.tcb); '-': standard input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "File to write; its name says the format: pdf or svg. '-': standard\noutput")
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
          "Largest error of a colour, in levels of 0 to 255; 0.01 to 255.\nWithout: 2 for PDF, 8 for SVG")
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
  command->footer(kExportFooter);
  command->callback([arguments] { export_frame(*arguments); });
}

}  // namespace knotreel::cli
