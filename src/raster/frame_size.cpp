// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/frame_size.h"

#include <cmath>

#include "knotreel/base/error.h"

namespace knotreel::raster {

namespace {

constexpr int kMaxSize = 1 << 24;

void require(bool condition, const char* message) {
  if (!condition) throw Error(ErrorKind::kInvalidArgument, message);
}

}  // namespace

FrameSize resolve_size(const document::FrameModel& model, const RenderOptions& options) {
  const std::optional<std::string> defect = document::find_defect(model);
  if (defect) throw Error(ErrorKind::kInvalidArgument, "cannot draw a frame: " + *defect);
  const auto& mesh = model.space->mesh();
  FrameSize s{};
  s.width = options.width != 0 ? options.width : static_cast<int>(std::lround(mesh.width));
  s.height = options.height != 0 ? options.height : static_cast<int>(std::lround(mesh.height));
  require(s.width >= 1 && s.height >= 1 && s.width <= kMaxSize && s.height <= kMaxSize,
          "the size of a picture to render must be between 1 and 16777216 pixels a side");
  s.crop_x = options.crop_x;
  s.crop_y = options.crop_y;
  require(s.crop_x >= 0 && s.crop_y >= 0 && s.crop_x < s.width && s.crop_y < s.height &&
              options.crop_width >= 0 && options.crop_height >= 0,
          "the crop lies outside the picture");
  s.crop_width = options.crop_width != 0 ? options.crop_width : s.width - s.crop_x;
  s.crop_height = options.crop_height != 0 ? options.crop_height : s.height - s.crop_y;
  require(s.crop_width <= s.width - s.crop_x && s.crop_height <= s.height - s.crop_y,
          "the crop reaches beyond the picture");
  s.pixel_width = mesh.width / s.width;
  s.pixel_height = mesh.height / s.height;
  return s;
}

}  // namespace knotreel::raster
