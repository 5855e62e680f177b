#include "fit/region_moments.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

// Pixels count as this far from their centres, so that those on a line are on one side of it for all regions:
// that of spline::inward_direction().
constexpr Vec2 kAside{0.819e-9, 0.574e-9};

KNOTREEL_MULTIVERSION
void sum_row(const std::array<const float*, 4>& quantity, std::size_t channels, int width, double cell_width,
             RunningSums::Sums* out) {
  RunningSums::Sums sums{};
  for (int i = 0; i < width; ++i) {
    out[i] = sums;
    const double x = (i + 0.5) * cell_width;
    Channels q{};
    for (std::size_t c = 0; c < channels; ++c) q[c] = static_cast<double>(quantity[c][i]);
    for (std::size_t c = 0; c < 4; ++c) {
      sums.one[c] += q[c];
      sums.x[c] += q[c] * x;
      sums.xx[c] += q[c] * x * x;
    }
  }
  out[width] = sums;
}

/// Adds the pixels between two places of a row at x = `origin`, y = 0.
void add_run(const RunningSums::Sums& from, const RunningSums::Sums& to, double origin, double y,
             Moments& moments) {
  for (std::size_t c = 0; c < 4; ++c) {
    const double one = to.one[c] - from.one[c];
    const double far_x = to.x[c] - from.x[c];
    const double x = far_x - origin * one;
    const double xx = (to.xx[c] - from.xx[c]) - origin * (far_x + x);
    moments.one[c] += one;
    moments.x[c] += x;
    moments.xx[c] += xx;
    moments.y[c] += y * one;
    moments.xy[c] += y * x;
    moments.yy[c] += y * y * one;
  }
}

}  // namespace

RunningSums::RunningSums(std::span<const std::vector<float>> channels, int width, int begin, int end,
                         double cell_width)
    : width_(width),
      begin_(begin),
      end_(end),
      sums_(std::make_unique_for_overwrite<Sums[]>((static_cast<std::size_t>(width) + 1) *
                                                   static_cast<std::size_t>(end - begin))) {
  parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
    const std::size_t row_begin = (static_cast<std::size_t>(begin) + i) * static_cast<std::size_t>(width);
    std::array<const float*, 4> quantity{};
    for (std::size_t c = 0; c < channels.size(); ++c) quantity[c] = channels[c].data() + row_begin;
    sum_row(quantity, channels.size(), width, cell_width,
            sums_.get() + i * (static_cast<std::size_t>(width) + 1));
  });
}

void Region::cut(const Plane& plane) {
  // A level plane bounds nothing or everything: its zero is far to the left or right.
  const double slope = plane.x != 0 ? plane.x : 1e-100;
  const double c = plane.c + kAside.x * plane.x + kAside.y * plane.y;
  const Bound bound{(origin_x_ - c / slope) / cell_width_ - 0.5, -plane.y / slope / cell_width_};
  if (slope > 0) {
    lower_[lower_count_++] = bound;
  } else {
    upper_[upper_count_++] = bound;
  }
}

KNOTREEL_MULTIVERSION
void Region::add_row(const RunningSums::Sums* sums, double y, Moments& moments) const {
  double low = left_;
  double high = right_;
  for (std::size_t i = 0; i < lower_count_; ++i) low = std::max(low, lower_[i].at + lower_[i].by_y * y);
  for (std::size_t i = 0; i < upper_count_; ++i) high = std::min(high, upper_[i].at + upper_[i].by_y * y);
  if (!(low < high)) return;
  const auto begin = static_cast<std::size_t>(std::ceil(low));
  const auto end = static_cast<std::size_t>(std::ceil(high));
  if (begin < end) add_run(sums[begin], sums[end], origin_x_, y, moments);
}

}  // namespace knotreel::fit
