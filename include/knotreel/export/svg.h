// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/output_file.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/export/options.h"

namespace knotreel::exporting {

/// Writes one frame as an SVG 1.1 picture: regions of one colour or one linear gradient each, with outlines
/// of Bezier curves, exact along features; alpha as a mask (docs/export.md). What `options.tessellation`
/// allows is shared by the triangles that regions are made from and their paints; strips that change no pixel
/// of the picture by more than the colour tolerance, or by 2 levels, may be left away. Does not commit the
/// file. Memory: proportional to the triangles. Bytes and errors as write_pdf().
ExportReport write_svg(const document::FrameModel& model, const ExportOptions& options, OutputFile& file);

}  // namespace knotreel::exporting
