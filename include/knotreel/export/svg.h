#pragma once

#include "knotreel/base/output_file.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/export/options.h"

namespace knotreel::exporting {

/// Writes one frame as an SVG 1.1 picture: triangles with a linear gradient each, overlapping a little,
/// clipped exactly along features; alpha as a mask (docs/export.md). SVG has no shading that fits, so at
/// equal tolerance files are 20 to 100 times those of PDF. Does not commit the file. Memory, bytes and
/// errors as write_pdf().
ExportReport write_svg(const document::FrameModel& model, const ExportOptions& options, OutputFile& file);

}  // namespace knotreel::exporting
