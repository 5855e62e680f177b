#pragma once

#include <vector>

#include "knotreel/fit/pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Values of all basis functions at all pixels, the matrix A of the least-squares problems, in bands of rows.
/// Values of pictures of one band are kept, those of larger ones are made anew for each pass, so that memory
/// stays bounded (about 250 MB).
class PixelValues {
 public:
  /// All arguments must outlive this. The pixels cover the domain; each is a whole number of units wide and
  /// high (1, but for pictures made smaller).
  /// @param wanted one per function: 0 counts as zero everywhere, and costs nothing; or none: all.
  /// @throws Error{kInvalidArgument} if domain and picture do not fit.
  PixelValues(const spline::Basis& basis, int width, int height, std::span<const Vec2> places,
              std::span<const std::uint8_t> wanted = {});

  const spline::Basis& basis() const { return *basis_; }
  int width() const { return width_; }
  int height() const { return height_; }

  /// Calls visit(const GridValues&, row_begin, row_end) for each band from top to bottom.
  template <class Visit>
  void for_bands(Visit&& visit) const {
    for (int y = 0; y < height_; y += band_rows_) {
      const int end = std::min(height_, y + band_rows_);
      if (kept_.empty()) {
        visit(make(y, end), y, end);
      } else {
        visit(kept_.front(), y, end);
      }
    }
  }

 private:
  spline::GridValues make(int begin, int end) const;

  const spline::Basis* basis_;
  int width_;
  int height_;
  std::span<const Vec2> places_;
  std::span<const std::uint8_t> wanted_;
  int band_rows_;
  std::vector<spline::GridValues> kept_;
};

/// For each pixel, sum over functions of value times control point.
/// @param control function by function, `channels` numbers each.
/// @param out     row-major, channels interleaved.
void surface_at_pixels(const PixelValues& values, std::span<const double> control, int channels,
                       std::span<double> out);

}  // namespace knotreel::fit
