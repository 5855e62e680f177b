#pragma once

#include <cstdint>
#include <functional>

#include "knotreel/export/tessellate.h"

namespace knotreel::exporting {

/// How the picture lies on the page: turned by whole quarters, and mirrored if need be.
struct PageTurn {
  /// Of a step to the right, and of one down, in the picture: where it leads on the page.
  int right_x = 1, right_y = 0;
  int down_x = 0, down_y = 1;

  bool is_none() const { return right_x == 1 && down_y == 1; }
  bool swaps_sides() const { return right_x == 0; }
  /// Where the origin of a picture lies on its page.
  Vec2 origin(double page_width, double page_height) const {
    return {right_x < 0 || down_x < 0 ? page_width : 0, right_y < 0 || down_y < 0 ? page_height : 0};
  }
};

struct ExportOptions {
  TessellationOptions tessellation;
  /// Size of a picture pixel on the page: points (1/72 inch) in PDF, user units (CSS pixels) in SVG;
  /// 0.001 to 1000.
  double scale = 1;
  /// More triangles than that are refused: files of many hundred megabytes help nobody.
  std::uint64_t max_triangles = 4'000'000;
  /// Called between units of work of about a tenth of a second; may throw to stop the export.
  std::function<void()> checkpoint;
  PageTurn turn{};
};

struct ExportReport {
  std::size_t layers = 0;
  std::uint64_t triangles = 0;  ///< all that were written, rims and alpha included
};

}  // namespace knotreel::exporting
