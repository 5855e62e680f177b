// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/drawing_file.h"

#include "cli/command.h"
#include "cli/interrupt.h"
#include "knotreel/export/pdf.h"
#include "knotreel/export/svg.h"

namespace knotreel::cli {

namespace {

// Above this, programs that show SVG become slow.
constexpr std::uint64_t kLargeSvgBytes = 20'000'000;
// Hardly to be told from the surface; and what keeps SVG at some megabytes.
constexpr double kPdfTolerance = 2;
constexpr double kSvgTolerance = 6;

}  // namespace

exporting::ExportOptions drawing_options(const std::string& format) {
  exporting::ExportOptions options;
  options.tessellation.colour_tolerance = format == "pdf" ? kPdfTolerance : kSvgTolerance;
  options.checkpoint = check_interrupted;
  return options;
}

void write_drawing(const document::FrameModel& model, const exporting::ExportOptions& options,
                   const std::string& format, OutputFile& file) {
  if (format == "pdf") {
    write_pdf(model, options, file);
  } else {
    write_svg(model, options, file);
  }
}

void warn_if_large(std::uint64_t bytes, const std::string& format) {
  if (format != "svg" || bytes <= kLargeSvgBytes) return;
  warn("the SVG has " + std::to_string(bytes / 1'000'000) +
       " MB, which many programs show slowly; a larger --colour-tolerance of 'export' makes it smaller");
}

}  // namespace knotreel::cli
