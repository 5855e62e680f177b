#include "knotreel/fit/pixel_values.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

// Pixels of a band: about 250 MB of values.
constexpr int kBandPixels = 1 << 22;

// Rows of pixels that are made at a time: all functions are looked at for each lot of them.
constexpr int kLot = 32;

/// Sums of some rows of pixels, channel by channel, because vectors of pixels want no interleaving.
struct Planes {
  int top;
  std::size_t width;
  std::size_t size;  ///< of one channel
  double* sums;
};

template <std::size_t Channels>
[[gnu::always_inline]] inline void add_channels(std::span<const spline::GridValues::Row> rows,
                                                const double* values, const double* control,
                                                const Planes& planes) {
  for (const spline::GridValues::Row& row : rows) {
    const double* __restrict v = values + row.offset;
    const std::int32_t count = row.x_end - row.x_begin;
    double* to = planes.sums + static_cast<std::size_t>(row.y - planes.top) * planes.width + row.x_begin;
    for (std::size_t c = 0; c < Channels; ++c, to += planes.size) {
      double* __restrict sums = to;
      const double weight = control[c];
      for (std::int32_t i = 0; i < count; ++i) sums[i] += v[i] * weight;
    }
  }
}

/// Adds a function times a control point in some rows.
KNOTREEL_MULTIVERSION
void add_function(std::span<const spline::GridValues::Row> rows, const double* values, const double* control,
                  std::size_t channels, const Planes& planes) {
  switch (channels) {
    case 1:
      return add_channels<1>(rows, values, control, planes);
    case 2:
      return add_channels<2>(rows, values, control, planes);
    case 3:
      return add_channels<3>(rows, values, control, planes);
    default:
      return add_channels<4>(rows, values, control, planes);
  }
}

/// Those of consecutive rows that are within [begin, end).
std::span<const spline::GridValues::Row> between(std::span<const spline::GridValues::Row> rows, int begin,
                                                 int end) {
  if (rows.empty()) return rows;
  const int first = std::clamp(begin - rows.front().y, 0, static_cast<int>(rows.size()));
  const int last = std::clamp(end - rows.front().y, first, static_cast<int>(rows.size()));
  return rows.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
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
    parallel_for(static_cast<std::size_t>((end - begin + kLot - 1) / kLot), [&](std::size_t lot) {
      const int top = begin + static_cast<int>(lot) * kLot;
      const int bottom = std::min(end, top + kLot);
      const std::size_t pixels = static_cast<std::size_t>(bottom - top) * width;
      thread_local std::vector<double> sums;
      sums.assign(pixels * channels, 0.0);
      const Planes planes{top, width, pixels, sums.data()};
      for (spline::FunctionIndex f = 0; f + 1 < grid.row_begin.size(); ++f) {
        const auto rows = between(grid.rows_of(f), top, bottom);
        if (!rows.empty())
          add_function(rows, grid.values.data(), control.data() + f * channels, channels, planes);
      }
      double* to = out.data() + static_cast<std::size_t>(top) * width * channels;
      for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < channels; ++c) to[i * channels + c] = sums[c * pixels + i];
      }
    });
  });
}

}  // namespace knotreel::fit
