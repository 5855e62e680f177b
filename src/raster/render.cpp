// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/raster/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/tiles_around.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/fit/pixel_places.h"
#include "knotreel/spline/surface.h"
#include "raster/colour_mean.h"
#include "raster/feature_trace.h"
#include "raster/frame_size.h"
#include "raster/part.h"
#include "raster/reduce.h"
#include "raster/sample_pattern.h"
#include "raster/soften.h"
#include "raster/surface.h"
#include "raster/tile.h"

namespace knotreel::raster {

namespace {

constexpr std::size_t kSamples = 64;
// Of the tiles of pictures of the size of the model.
constexpr int kPlacedSide = spline::PixelValues::kSide;

// The places of the pixels of larger pictures are not found for all of them at once, to save memory.
constexpr double kMostPlaced = 1 << 22;

/// The first of pixels in the order of rows that does not come before (x, y).
auto first_from(std::span<const CrossedPixel> pixels, int x, int y) {
  return std::partition_point(pixels.begin(), pixels.end(), [&](const CrossedPixel& pixel) {
    return pixel.y < y || (pixel.y == y && pixel.x < x);
  });
}

}  // namespace

struct Renderer::State {
  State(const document::FrameModel& model, const RenderOptions& options,
        std::shared_ptr<const spline::Basis> basis, std::shared_ptr<const spline::PixelSurface> given,
        std::span<const std::uint8_t> some_tiles = {})
      : size(resolve_size(model, options)),
        surface(model, basis),
        tiles(tiles_to_draw(some_tiles)),
        trace(surface, model.space->mesh(), tiles),
        channels(static_cast<std::size_t>(model.channels)),
        antialias(options.antialias),
        softness(antialias ? model.edge_softness : 0) {
    reduce_x = static_cast<int>(std::ceil(size.pixel_width - 1e-9));
    reduce_y = static_cast<int>(std::ceil(size.pixel_height - 1e-9));
    fine_width = size.pixel_width / reduce_x;
    fine_height = size.pixel_height / reduce_y;
    // Tiles of about 2.7 pixels of the model: few pieces end inside. But 8 x 8 points must share the set-up.
    const auto side = [](double pixel) {
      return std::clamp(static_cast<int>(std::lround(2.7 / pixel)), 8, 16);
    };
    tile_width = side(fine_width);
    tile_height = side(fine_height);
    if (size.pixel_width != 1 || size.pixel_height != 1) return;
    if (is_large()) return;
    tile_width = tile_height = kPlacedSide;
    if (given) {
      if (given->colours.size() != static_cast<std::size_t>(size.width) * std::size_t(size.height) * channels)
        throw Error(ErrorKind::kInvalidArgument, "a surface at other pixels is of no use to draw with");
      known = std::move(given);
      return;
    }
    colour = model.colour;
    placed = fit::place_basis(basis, model.displacement);
  }

  bool is_large() const { return surface.width() * surface.height() > kMostPlaced; }

  /// Some, and those around, which softening looks at; none: all.
  std::vector<std::uint8_t> tiles_to_draw(std::span<const std::uint8_t> some) const {
    if (some.empty() || is_large()) return {};
    const auto columns = static_cast<std::size_t>((size.width + kPlacedSide - 1) / kPlacedSide);
    return tiles_around(some, columns, 1);
  }

  void fine_rows(int row_begin, int row_end, int column_begin, int column_end, float* out) const;
  void draw(const Part& part, std::span<const CrossedPixel> crossed) const;
  void draw_block(int tile_x0, int tile_y0, int tile_x1, int tile_y1, std::span<const CrossedPixel> crossed,
                  const Part& part) const;
  /// Whether the pixels are those that the surface is fitted to.
  bool is_fitted_size() const { return known || placed; }

  bool is_drawn(int tile_x, int tile_y) const {
    const int columns = (size.width + tile_width - 1) / tile_width;
    return tiles.empty() || tiles[static_cast<std::size_t>(tile_y * columns + tile_x)] != 0;
  }

  void copy_known(const Part& part) const;
  void draw_placed(int x0, int y0, const Part& part) const;
  template <class Value>
  void store_tile(const Value* colours, std::size_t stride, int x0, int y0, const Part& part) const;
  void draw_centres(Tile& tile, int x0, int y0, const Part& part) const;
  void draw_crossed(Tile& tile, std::span<const CrossedPixel> pixels, const Part& part) const;
  void draw_split(Tile& tile, std::span<const CrossedPixel> pixels, const Part& part) const;

  FrameSize size;
  Surface surface;
  std::vector<std::uint8_t> tiles;  ///< that are drawn; none: all
  FeatureTrace trace;
  std::size_t channels;
  bool antialias;
  double softness;  ///< of edges
  /// Of pictures of the size of the model: the colours of their pixels, or the basis there and the colours of
  /// its control points.
  std::shared_ptr<const spline::PixelSurface> known;
  std::shared_ptr<const spline::PlacedBasis> placed;
  std::vector<double> colour;
  // The grid that is drawn is finer than the output where the picture is made smaller.
  int reduce_x;
  int reduce_y;
  double fine_width;  ///< of a fine pixel, in pixels of the model
  double fine_height;
  int tile_width;
  int tile_height;
};

/// Stores the pixels of a tile that are in the part. @param colours channel by channel, `stride` apart.
template <class Value>
void Renderer::State::store_tile(const Value* colours, std::size_t stride, int x0, int y0,
                                 const Part& part) const {
  const int x1 = std::min(x0 + tile_width, part.column_end);
  const int y1 = std::min(y0 + tile_height, part.row_end);
  for (int py = std::max(y0, part.row_begin); py < y1; ++py) {
    for (int px = std::max(x0, part.column_begin); px < x1; ++px) {
      const auto i = static_cast<std::size_t>((py - y0) * tile_width + (px - x0));
      for (std::size_t c = 0; c < channels; ++c)
        part.at(px, py)[c] = static_cast<float>(colours[c * stride + i]);
    }
  }
}

/// The surface at the centres of all pixels of a tile.
void Renderer::State::draw_centres(Tile& tile, int x0, int y0, const Part& part) const {
  alignas(64) std::array<double, kBatch> x;
  alignas(64) std::array<double, kBatch> y;
  alignas(64) std::array<double, 4 * kBatch> colours;
  const int n = tile_width * tile_height;
  for (int i = 0; i < n; ++i) {
    x[static_cast<std::size_t>(i)] = (x0 + i % tile_width + 0.5) * fine_width;
    y[static_cast<std::size_t>(i)] = (y0 + i / tile_width + 0.5) * fine_height;
  }
  tile.colours(x.data(), y.data(), n, colours.data());
  store_tile(colours.data(), kBatch, x0, y0, part);
}

/// The same for all tiles, where that is known.
void Renderer::State::copy_known(const Part& part) const {
  for (int y = part.row_begin; y < part.row_end; ++y) {
    const auto first = static_cast<std::size_t>(y) * std::size_t(size.width) + std::size_t(part.column_begin);
    std::copy_n(known->colours.data() + first * channels, part.columns() * channels,
                part.at(part.column_begin, y));
  }
}

/// The same, where the basis has been evaluated there.
void Renderer::State::draw_placed(int x0, int y0, const Part& part) const {
  spline::TileSurface<float> colours;
  const spline::PixelValues& values = placed->values();
  const std::size_t index = static_cast<std::size_t>(y0 / kPlacedSide) * values.tile_columns() +
                            static_cast<std::size_t>(x0 / kPlacedSide);
  spline::surface_of_tile(values, index, {colour, static_cast<int>(channels)}, colours);
  store_tile(colours.data(), spline::PixelValues::kTilePixels, x0, y0, part);
}

/// Means over those pixels of a tile that a curve splits in two: by the colours at the centroids of both
/// parts.
void Renderer::State::draw_split(Tile& tile, std::span<const CrossedPixel> pixels, const Part& part) const {
  alignas(64) std::array<double, kBatch> x;
  alignas(64) std::array<double, kBatch> y;
  alignas(64) std::array<double, 4 * kBatch> colours;
  for (std::size_t first = 0; first < pixels.size();) {
    std::size_t n = 0;
    std::size_t last = first;
    for (; last < pixels.size() && n + 2 <= kBatch; ++last) {
      if (!pixels[last].parts) continue;
      for (const PixelPart& side : *pixels[last].parts) {
        x[n] = side.centre.x * fine_width;
        y[n++] = side.centre.y * fine_height;
      }
    }
    if (n > 0) tile.colours(x.data(), y.data(), static_cast<int>(n), colours.data());
    const double* side_colour = colours.data();
    for (const CrossedPixel& pixel : pixels.subspan(first, last - first)) {
      if (!pixel.parts) continue;
      ColourMean mean(channels);
      for (const PixelPart& side : *pixel.parts) mean.add(side_colour++, kBatch, side.share);
      if (part.contains(pixel.x, pixel.y)) mean.store(part.at(pixel.x, pixel.y));
    }
    first = last;
  }
}

/// Means over pixels of a tile that features cross.
void Renderer::State::draw_crossed(Tile& tile, std::span<const CrossedPixel> pixels, const Part& part) const {
  static const std::array<Vec2, kSamples> pattern = sample_pattern<kSamples>();
  alignas(64) std::array<double, kBatch> x;
  alignas(64) std::array<double, kBatch> y;
  alignas(64) std::array<double, 4 * kBatch> colours;
  draw_split(tile, pixels, part);
  for (const CrossedPixel& pixel : pixels) {
    if (pixel.parts || !part.contains(pixel.x, pixel.y)) continue;
    for (std::size_t i = 0; i < kSamples; ++i) {
      x[i] = (pixel.x + pattern[i].x) * fine_width;
      y[i] = (pixel.y + pattern[i].y) * fine_height;
    }
    tile.colours(x.data(), y.data(), static_cast<int>(kSamples), colours.data());
    ColourMean mean(channels);
    for (std::size_t i = 0; i < kSamples; ++i) mean.add(colours.data() + i, kBatch);
    mean.store(part.at(pixel.x, pixel.y));
  }
}

/// Tiles [tile_x0, tile_x1) x [tile_y0, tile_y1), which share a look-up of terms.
void Renderer::State::draw_block(int tile_x0, int tile_y0, int tile_x1, int tile_y1,
                                 std::span<const CrossedPixel> crossed, const Part& part) const {
  Tile tile(surface);
  bool is_set = false;
  std::vector<CrossedPixel> pixels;
  for (int ty = tile_y0; ty < tile_y1; ++ty) {
    for (int tx = tile_x0; tx < tile_x1; ++tx) {
      if (!is_drawn(tx, ty)) continue;
      const int x0 = tx * tile_width;
      const int y0 = ty * tile_height;
      pixels.clear();
      for (int y = y0; y < y0 + tile_height && !crossed.empty(); ++y) {
        pixels.insert(pixels.end(), first_from(crossed, x0, y), first_from(crossed, x0 + tile_width, y));
      }
      if (placed) draw_placed(x0, y0, part);
      if (is_fitted_size() && pixels.empty()) continue;
      if (!is_set) {
        tile.set_block({tile_x0 * tile_width * fine_width, tile_y0 * tile_height * fine_height},
                       {tile_x1 * tile_width * fine_width, tile_y1 * tile_height * fine_height});
        is_set = true;
      }
      // The whole tile takes part in the set-up, whatever part of it is asked for: same bits for any crop or
      // band.
      tile.set({x0 * fine_width, y0 * fine_height},
               {(x0 + tile_width) * fine_width, (y0 + tile_height) * fine_height});
      if (!is_fitted_size()) draw_centres(tile, x0, y0, part);
      draw_crossed(tile, pixels, part);
    }
  }
}

void Renderer::State::draw(const Part& part, std::span<const CrossedPixel> crossed) const {
  if (known) copy_known(part);
  const int first_column = part.column_begin / tile_width;
  const int last_column = (part.column_end - 1) / tile_width;
  const int first_row = part.row_begin / tile_height;
  const int last_row = (part.row_end - 1) / tile_height;
  constexpr int kBlockColumns = 8;
  constexpr int kBlockRows = 4;
  const int blocks_per_row = (last_column - first_column) / kBlockColumns + 1;
  const int block_rows = (last_row - first_row) / kBlockRows + 1;
  parallel_for(static_cast<std::size_t>(block_rows * blocks_per_row), [&](std::size_t block) {
    const int i = static_cast<int>(block);
    const int x0 = first_column + i % blocks_per_row * kBlockColumns;
    const int y0 = first_row + i / blocks_per_row * kBlockRows;
    draw_block(x0, y0, std::min(x0 + kBlockColumns, last_column + 1), std::min(y0 + kBlockRows, last_row + 1),
               crossed, part);
  });
}

void Renderer::State::fine_rows(int row_begin, int row_end, int column_begin, int column_end,
                                float* out) const {
  const Part inner{{row_begin, row_end, column_begin, column_end}, channels, out};
  Part drawn = inner;
  std::vector<float> wider;
  if (softness > 0) {  // which takes the pixels around, too
    drawn.row_begin = std::max(row_begin - kSoftReach, 0);
    drawn.row_end = std::min(row_end + kSoftReach, size.height * reduce_y);
    drawn.column_begin = std::max(column_begin - kSoftReach, 0);
    drawn.column_end = std::min(column_end + kSoftReach, size.width * reduce_x);
    if (drawn.pixel_count() > inner.pixel_count()) {
      wider.resize(drawn.pixel_count() * channels);
      drawn.out = wider.data();
    }
  }
  std::vector<CrossedPixel> crossed;
  if (antialias) {  // in whole tiles, whose points are worked on together
    const auto down = [](int v, int side) { return v / side * side; };
    const auto up = [](int v, int side) { return (v + side - 1) / side * side; };
    crossed = trace.crossed_pixels(fine_width, fine_height, down(drawn.row_begin, tile_height),
                                   up(drawn.row_end, tile_height), down(drawn.column_begin, tile_width),
                                   up(drawn.column_end, tile_width));
  }
  draw(drawn, crossed);
  if (softness > 0) soften_edges(crossed, softness, inner, drawn);
  if (wider.empty()) return;
  for (int y = row_begin; y < row_end; ++y)
    std::copy_n(drawn.at(column_begin, y), inner.columns() * channels, inner.at(column_begin, y));
}

Renderer::Renderer(const document::FrameModel& model, const RenderOptions& options)
    : Renderer(model, options, std::make_shared<const spline::Basis>(model.space)) {}
Renderer::Renderer(const document::FrameModel& model, const RenderOptions& options,
                   std::shared_ptr<const spline::Basis> basis,
                   std::shared_ptr<const spline::PixelSurface> known)
    : state_(std::make_unique<State>(model, options, std::move(basis), std::move(known))) {}
Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}

image::Image Renderer::in_tiles(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis,
                                std::shared_ptr<const spline::PixelSurface> known,
                                std::span<const std::uint8_t> tiles) {
  return Renderer(std::make_unique<State>(model, RenderOptions(), std::move(basis), std::move(known), tiles))
      .whole();
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

int Renderer::width() const {
  return state_->size.crop_width;
}
int Renderer::height() const {
  return state_->size.crop_height;
}
int Renderer::channels() const {
  return static_cast<int>(state_->channels);
}

image::Image Renderer::whole() const {
  image::Image image = image::make_image(width(), height(), channels());
  rows(0, image.height, image.samples);
  return image;
}

void Renderer::rows(int begin, int end, std::span<float> out) const {
  const State& s = *state_;
  const auto row_samples = static_cast<std::size_t>(width()) * s.channels;
  if (begin < 0 || end < begin || end > height() ||
      out.size() != static_cast<std::size_t>(end - begin) * row_samples) {
    throw Error(ErrorKind::kInvalidArgument, "rows asked of a renderer do not fit the picture");
  }
  if (begin == end) return;
  const int x0 = s.size.crop_x;
  const int y0 = s.size.crop_y;
  if (s.reduce_x == 1 && s.reduce_y == 1) {
    s.fine_rows(y0 + begin, y0 + end, x0, x0 + width(), out.data());
    return;
  }
  const Part part{{y0 + begin, y0 + end, x0, x0 + width()}, s.channels, out.data()};
  reduce_rows(part, {s.reduce_x, s.reduce_y}, [&](const Region& fine, float* to) {
    s.fine_rows(fine.row_begin, fine.row_end, fine.column_begin, fine.column_end, to);
  });
}

std::vector<float> render(const document::FrameModel& model, const RenderOptions& options) {
  const Renderer renderer(model, options);
  std::vector<float> out(static_cast<std::size_t>(renderer.width()) *
                         static_cast<std::size_t>(renderer.height()) *
                         static_cast<std::size_t>(renderer.channels()));
  renderer.rows(0, renderer.height(), out);
  return out;
}

}  // namespace knotreel::raster
