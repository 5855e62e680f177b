// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "knotreel/base/output_file.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/export/options.h"

namespace knotreel::cli {

/// With the default tolerances of a format, "pdf" or "svg" (drawing_format()), and stopped by signals.
exporting::ExportOptions drawing_options(const std::string& format);

/// Writes a frame; does not commit the file.
void write_drawing(const document::FrameModel& model, const exporting::ExportOptions& options,
                   const std::string& format, OutputFile& file);

/// Tells of files that many programs show slowly.
void warn_if_large(std::uint64_t bytes, const std::string& format);

}  // namespace knotreel::cli
