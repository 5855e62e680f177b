#pragma once

#include <vector>

#include "knotreel/fit/pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Values of all basis functions at all pixels, times the square roots of the pixels' weights: the matrix A
/// of the least-squares problem, in bands of rows. Values of pictures of one band are kept, those of larger
/// ones are made anew for each pass, so that memory stays bounded (about 250 MB).
class PixelValues {
 public:
  /// All arguments must outlive this. @throws Error{kInvalidArgument} if domain and picture differ in size.
  PixelValues(const spline::Basis& basis, const Pixels& pixels);

  const spline::Basis& basis() const { return *basis_; }
  const Pixels& pixels() const { return pixels_; }
  const image::Image& image() const { return *pixels_.image; }

  /// Calls visit(const GridValues&, row_begin, row_end) for each band from top to bottom.
  template <class Visit>
  void for_bands(Visit&& visit) const {
    const int height = image().height;
    for (int y = 0; y < height; y += band_rows_) {
      const int end = std::min(height, y + band_rows_);
      if (kept_.empty()) {
        visit(make(y, end), y, end);
      } else {
        visit(kept_.front(), y, end);
      }
    }
  }

  /// Square root of the weight of a pixel.
  double root_weight(int x, int y) const;

 private:
  spline::GridValues make(int begin, int end) const;

  const spline::Basis* basis_;
  Pixels pixels_;
  int band_rows_;
  std::vector<spline::GridValues> kept_;
};

}  // namespace knotreel::fit
