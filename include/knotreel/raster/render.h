// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"
#include "knotreel/spline/pixel_surface.h"

/// Vector model -> pixels: for each output pixel the parameter u with S_geo(u) = x is found by Newton's
/// method, and the colour is S_col(u) (docs/algorithm.md, "rendering").
namespace knotreel::raster {

struct RenderOptions {
  int width = 0;        ///< of the whole picture, in output pixels; 0: as the model
  int height = 0;       ///< of the whole picture, in output pixels; 0: as the model
  int crop_x = 0;       ///< left of the part to render, in output pixels
  int crop_y = 0;       ///< top of the part to render, in output pixels
  int crop_width = 0;   ///< of the part to render; 0: up to the right end
  int crop_height = 0;  ///< of the part to render; 0: down to the lower end
  /// Pixels that a feature curve crosses become the mean of both sides, by exact areas where one curve goes
  /// through nearly straight, else by 64 samples. Without, every pixel takes the colour at its centre.
  bool antialias = true;
};

/// Draws one model at one size, in any order of rows. Between features a pixel is the surface at its centre;
/// where the picture is made smaller, it is the mean over the pixel's area.
///
/// Immutable once made; rows() may be called from several threads, and spreads its own work over all threads
/// allowed. The bits of a pixel depend on the model and on the size of the whole picture only: not on the
/// crop, the bands or the number of threads. Memory: proportional to the model, plus a few rows per call;
/// about 40 bytes per pixel more where the whole picture has the size of the model and up to 2^22 pixels.
class Renderer {
 public:
  /// @throws Error{kInvalidArgument} for sizes below 1 or above 2^24, a crop outside the picture, or a model
  /// with a defect (document::find_defect()).
  Renderer(const document::FrameModel& model, const RenderOptions& options = {});
  /// @param basis  of the space of the model, for callers who have it.
  /// @param known the colours of the model at the centres of the pixels of its own size, in single precision
  /// as spline::surface_at_pixels() at fit::pixel_places(), for callers who have them; or null.
  /// @throws Error{kInvalidArgument} as above, and for `known` of another size where it is used.
  Renderer(const document::FrameModel& model, const RenderOptions& options,
           std::shared_ptr<const spline::Basis> basis,
           std::shared_ptr<const spline::PixelSurface> known = nullptr);
  /// The picture of the size of the model, in some of its tiles; other pixels are anything. Of pictures
  /// above 2^22 pixels all are drawn.
  /// @param basis, known as above. @param tiles by tile of spline::PixelTiles: 1 for those that are drawn.
  static image::Image in_tiles(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis,
                               std::shared_ptr<const spline::PixelSurface> known,
                               std::span<const std::uint8_t> tiles);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  int width() const;     ///< of the part rendered, in pixels
  int height() const;    ///< of the part rendered, in pixels
  int channels() const;  ///< as the model

  /// Rows [begin, end) of the part rendered, 0 <= begin <= end <= height(): row-major, channels interleaved,
  /// scale 0..255, not clamped (splines overshoot). Alpha is not premultiplied.
  /// @param out (end - begin) * width() * channels() samples. @throws Error{kInvalidArgument} for other rows,
  /// or if `out` has another size.
  void rows(int begin, int end, std::span<float> out) const;
  /// All rows.
  image::Image whole() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// The whole part at once, as Renderer::rows(). @throws as Renderer.
std::vector<float> render(const document::FrameModel& model, const RenderOptions& options = {});

/// The same picture by the recurrence of the paper and damped Newton steps for each pixel on its own, with 16
/// x 16 samples where a feature curve crosses a pixel: thousands of times slower, for tests.
std::vector<float> render_reference(const document::FrameModel& model, const RenderOptions& options = {});

}  // namespace knotreel::raster
