// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "knotreel/base/turn.h"
#include "knotreel/export/tessellate.h"

namespace knotreel::exporting {

struct ExportOptions {
  TessellationOptions tessellation;
  /// Size of a picture pixel on the page: points (1/72 inch) in PDF, user units (CSS pixels) in SVG;
  /// 0.001 to 1000.
  double scale = 1;
  /// More triangles than that are refused: files of many hundred megabytes help nobody. SVG takes some 700
  /// bytes of memory for each.
  std::uint64_t max_triangles = 4'000'000;
  /// Called between units of work of about a tenth of a second; may throw to stop the export.
  std::function<void()> checkpoint;
  Turn turn{};  ///< how the picture lies on the page
};

/// @throws Error{kInvalidArgument} for a scale or tolerances out of range; so does what writes.
void check_options(const ExportOptions& options);

struct ExportReport {
  std::size_t layers = 0;  ///< painted one over the other: groups of triangles in PDF, paths in SVG
  /// All that were written, rims and alpha included; in SVG those that the paths were made from.
  std::uint64_t triangles = 0;
};

}  // namespace knotreel::exporting
