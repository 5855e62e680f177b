// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/side_by_side.h"

#include <algorithm>

#include "cli/debug/drawings.h"
#include "knotreel/raster/render.h"
#include "knotreel/video/turn.h"

namespace knotreel::cli {
namespace {

constexpr int kWidest = 1920;  // pixels, unless the input is wider than a third of that

image::Image shown(const debug::Canvas& canvas, const Turn& turn) {
  const std::span<const std::uint8_t> rgb = canvas.rgb();
  return video::turned({canvas.width(), canvas.height(), 3, {rgb.begin(), rgb.end()}}, turn);
}

/// Puts a picture into another one, its left side at a column.
void paste(image::Image& image, const image::Image& part, int left) {
  for (int y = 0; y < part.height; ++y)
    std::copy(part.row(y).begin(), part.row(y).end(), image.row(y).begin() + 3 * left);
}

image::Image enlarged_model(const document::FrameModel& model, int scale) {
  const mesh::KnotMesh& mesh = model.space->mesh();
  const int width = scale * static_cast<int>(mesh.width);
  const int height = scale * static_cast<int>(mesh.height);
  image::Image drawn{width, height, model.channels,
                     raster::render(model, {.width = width, .height = height})};
  for (float& v : drawn.samples) v = std::clamp(v, 0.0F, 255.0F);
  return drawn;
}

}  // namespace

image::Image side_by_side(const image::Image& picture, const document::FrameModel& model, const Turn& turn) {
  const int wide = turn.swaps_sides() ? picture.height : picture.width;
  const int scale = std::clamp(kWidest / (3 * wide), 1, debug::debug_scale(picture.width, picture.height));
  const image::Image original = shown(debug::enlarged_by(scale, picture), turn);
  const image::Image mesh = shown(debug::draw_mapped_mesh(picture, model, scale), turn);
  const image::Image drawing = shown(debug::enlarged_by(1, enlarged_model(model, scale)), turn);
  const int width = original.width;
  // Encoders want even sizes.
  image::Image result = image::make_image((3 * width + 1) / 2 * 2, (original.height + 1) / 2 * 2, 3);
  paste(result, original, 0);
  paste(result, drawing, width);
  paste(result, mesh, 2 * width);
  return result;
}

}  // namespace knotreel::cli
