#include "knotreel/fit/pixel_values.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

// Pixels of a band: about 250 MB of values.
constexpr int kBandPixels = 1 << 22;

/// For each pixel row, the function rows in it.
class RowIndex {
 public:
  struct Entry {
    spline::FunctionIndex function;
    const spline::GridValues::Row* row;
  };

  RowIndex(const spline::GridValues& grid, int begin, int end)
      : first_(begin), begin_(static_cast<std::size_t>(end - begin) + 1, 0) {
    for (const auto& r : grid.rows) ++begin_[static_cast<std::size_t>(r.y - first_) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(grid.rows.size());
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (spline::FunctionIndex f = 0; f + 1 < grid.row_begin.size(); ++f) {
      for (const auto& r : grid.rows_of(f)) {
        entries_[cursor[static_cast<std::size_t>(r.y - first_)]++] = {f, &r};
      }
    }
  }

  std::span<const Entry> row(int y) const {
    const auto i = static_cast<std::size_t>(y - first_);
    return std::span(entries_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  int first_;
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
};

template <std::size_t Channels>
void add_span(const double* values, const double* control, std::int32_t count, double* out) {
  for (std::int32_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < Channels; ++c) {
      out[static_cast<std::size_t>(i) * Channels + c] += values[i] * control[c];
    }
  }
}

}  // namespace

PixelValues::PixelValues(const spline::Basis& basis, int width, int height, std::span<const Vec2> places,
                         std::span<const std::uint8_t> wanted)
    : basis_(&basis),
      width_(width),
      height_(height),
      places_(places),
      wanted_(wanted),
      band_rows_(std::max(1, kBandPixels / std::max(1, width))) {
  const auto& mesh = basis.space().mesh();
  if (width < 1 || height < 1 || std::fmod(mesh.width, width) != 0 || std::fmod(mesh.height, height) != 0) {
    throw Error(ErrorKind::kInvalidArgument, "a fit needs a knot mesh of the size of the picture");
  }
  if (!places.empty() && places.size() != std::size_t(width) * std::size_t(height)) {
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one place per pixel");
  }
  if (band_rows_ >= height) kept_.push_back(make(0, height));
}

spline::GridValues PixelValues::make(int begin, int end) const {
  return basis_->evaluate_pixels(width_, height_, places_, begin, end, wanted_);
}

void surface_at_pixels(const PixelValues& values, std::span<const double> control, int channels,
                       std::span<double> out) {
  const std::size_t row_size = static_cast<std::size_t>(values.width()) * static_cast<std::size_t>(channels);
  std::fill(out.begin(), out.end(), 0.0);
  values.for_bands([&](const spline::GridValues& grid, int begin, int end) {
    const RowIndex index(grid, begin, end);
    parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
      const int y = begin + static_cast<int>(i);
      double* row = out.data() + static_cast<std::size_t>(y) * row_size;
      for (const RowIndex::Entry& e : index.row(y)) {
        const double* v = grid.values.data() + e.row->offset;
        const double* c = control.data() + e.function * static_cast<std::size_t>(channels);
        double* at = row + static_cast<std::size_t>(e.row->x_begin) * static_cast<std::size_t>(channels);
        const std::int32_t count = e.row->x_end - e.row->x_begin;
        switch (channels) {
          case 1:
            add_span<1>(v, c, count, at);
            break;
          case 2:
            add_span<2>(v, c, count, at);
            break;
          case 3:
            add_span<3>(v, c, count, at);
            break;
          default:
            add_span<4>(v, c, count, at);
            break;
        }
      }
    });
  });
}

}  // namespace knotreel::fit
