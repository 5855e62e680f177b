#include "knotreel/fit/pixel_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/multiversion.h"
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

/// out[c][i] += values[i] * control[c] for all channels.
template <std::size_t Channels>
[[gnu::always_inline]] inline void add_channels(const double* __restrict values, const double* control,
                                                std::int32_t count, const std::array<double*, 4>& out) {
  for (std::size_t c = 0; c < Channels; ++c) {
    double* __restrict to = out[c];
    const double weight = control[c];
    for (std::int32_t i = 0; i < count; ++i) to[i] += values[i] * weight;
  }
}

KNOTREEL_MULTIVERSION
void add_span(const double* values, const double* control, std::size_t channels, std::int32_t count,
              const std::array<double*, 4>& out) {
  switch (channels) {
    case 1:
      return add_channels<1>(values, control, count, out);
    case 2:
      return add_channels<2>(values, control, count, out);
    case 3:
      return add_channels<3>(values, control, count, out);
    default:
      return add_channels<4>(values, control, count, out);
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

void surface_at_pixels(const PixelValues& values, std::span<const double> control, int channel_count,
                       std::span<double> out) {
  const auto width = static_cast<std::size_t>(values.width());
  const auto channels = static_cast<std::size_t>(channel_count);
  values.for_bands([&](const spline::GridValues& grid, int begin, int end) {
    const RowIndex index(grid, begin, end);
    parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
      const int y = begin + static_cast<int>(i);
      // Channel by channel, because vectors of pixels want no interleaving.
      thread_local std::vector<double> planes;
      planes.assign(width * channels, 0.0);
      for (const RowIndex::Entry& e : index.row(y)) {
        std::array<double*, 4> at{};
        for (std::size_t c = 0; c < channels; ++c) at[c] = planes.data() + c * width + e.row->x_begin;
        add_span(grid.values.data() + e.row->offset, control.data() + e.function * channels, channels,
                 e.row->x_end - e.row->x_begin, at);
      }
      double* row = out.data() + static_cast<std::size_t>(y) * width * channels;
      for (std::size_t x = 0; x < width; ++x) {
        for (std::size_t c = 0; c < channels; ++c) row[x * channels + c] = planes[c * width + x];
      }
    });
  });
}

}  // namespace knotreel::fit
