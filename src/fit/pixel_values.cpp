#include "fit/pixel_values.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

// Pixels of a band: about 250 MB of values.
constexpr int kBandPixels = 1 << 22;

}  // namespace

PixelValues::PixelValues(const spline::Basis& basis, const Pixels& pixels)
    : basis_(&basis), pixels_(pixels), band_rows_(std::max(1, kBandPixels / pixels.image->width)) {
  const auto& mesh = basis.space().mesh();
  if (mesh.width != image().width || mesh.height != image().height) {
    throw Error(ErrorKind::kInvalidArgument, "a fit needs a knot mesh of the size of the picture");
  }
  const std::size_t count = image().pixel_count();
  if ((!pixels.weights.empty() && pixels.weights.size() != count) ||
      (!pixels.places.empty() && pixels.places.size() != count)) {
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one weight and one place per pixel");
  }
  if (band_rows_ >= image().height) kept_.push_back(make(0, image().height));
}

double PixelValues::root_weight(int x, int y) const {
  if (pixels_.weights.empty()) return 1;
  const std::size_t i =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(image().width) + static_cast<std::size_t>(x);
  return std::sqrt(static_cast<double>(pixels_.weights[i]));
}

spline::GridValues PixelValues::make(int begin, int end) const {
  spline::GridValues values =
      basis_->evaluate_pixels(image().width, image().height, pixels_.places, begin, end);
  if (pixels_.weights.empty()) return values;
  const std::size_t functions = values.row_begin.size() - 1;
  parallel_for(functions, [&](std::size_t f) {
    for (const auto& row : values.rows_of(static_cast<spline::FunctionIndex>(f))) {
      double* v = values.values.data() + row.offset;
      for (std::int32_t x = row.x_begin; x < row.x_end; ++x, ++v) *v *= root_weight(x, row.y);
    }
  });
  return values;
}

}  // namespace knotreel::fit
