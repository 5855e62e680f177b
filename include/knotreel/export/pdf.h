// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/output_file.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/export/options.h"

namespace knotreel::exporting {

/// Writes one frame as a PDF page of the picture's size (PDF 1.4, above 14,400 points 1.6; free-form Gouraud
/// shadings, soft masks along features and for alpha; docs/export.md). Colours are DeviceGray or DeviceRGB,
/// clamped to 0..255, 8 bits. Does not commit the file. Memory: proportional to the model, whatever the
/// number of triangles. Equal bytes for equal input, for any number of threads.
/// @throws Error{kInvalidArgument} for options out of range or more triangles than allowed, Error{kOutput}.
ExportReport write_pdf(const document::FrameModel& model, const ExportOptions& options, OutputFile& file);

}  // namespace knotreel::exporting
