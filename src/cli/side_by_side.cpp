#include "cli/side_by_side.h"

#include <algorithm>

#include "cli/debug/drawings.h"
#include "knotreel/raster/render.h"

namespace knotreel::cli {
namespace {

constexpr int kWidest = 1920;  // pixels, unless the input is wider than a third of that

/// Puts a canvas into a picture, its left side at a column.
void paste(image::Image& image, const debug::Canvas& canvas, int left) {
  const std::span<const std::uint8_t> rgb = canvas.rgb();
  const auto row = static_cast<std::size_t>(3 * canvas.width());
  for (int y = 0; y < canvas.height(); ++y) {
    float* to = image.row(y).data() + 3 * left;
    for (std::size_t i = 0; i < row; ++i) to[i] = rgb[std::size_t(y) * row + i];
  }
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

image::Image side_by_side(const image::Image& picture, const document::FrameModel& model) {
  const int scale =
      std::clamp(kWidest / (3 * picture.width), 1, debug::debug_scale(picture.width, picture.height));
  const debug::Canvas original = debug::enlarged_by(scale, picture);
  const debug::Canvas mesh = debug::draw_mapped_mesh(picture, model, scale);
  const debug::Canvas drawing = debug::enlarged_by(1, enlarged_model(model, scale));
  const int width = original.width();
  // Encoders want even sizes.
  image::Image result = image::make_image((3 * width + 1) / 2 * 2, (original.height() + 1) / 2 * 2, 3);
  paste(result, original, 0);
  paste(result, drawing, width);
  paste(result, mesh, 2 * width);
  return result;
}

}  // namespace knotreel::cli
