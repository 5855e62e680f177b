// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/warp.h"

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "motion/bilinear.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

/// Row y of a picture seen along a flow.
/// @param flow of that row.
KNOTREEL_MULTIVERSION
void warp_row(const float* __restrict to, int width, int height, int y, const float* __restrict flow,
              std::uint8_t* __restrict out) {
  for (int x = 0; x < width; ++x) {
    const Cell cell =
        cell_at(float(x) + 0.5F + flow[2 * x], float(y) + 0.5F + flow[2 * x + 1], width, height);
    out[x] = std::uint8_t(int(cell.sample(to, 1) + 0.5F));
  }
}

}  // namespace

image::Image warp(const image::Image& to, const Flow& flow) {
  check_sizes(to, flow);
  image::Image result{to.width, to.height, to.channels, std::vector<float>(to.samples.size())};
  const auto width = std::size_t(to.width);
  const auto channels = std::size_t(to.channels);
  parallel_for(std::size_t(flow.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t pixel = y * width + x;
      const float* d = flow.xy.data() + 2 * pixel;
      const Cell cell = cell_at(float(x) + 0.5F + d[0], float(y) + 0.5F + d[1], flow.width, flow.height);
      float* out = result.samples.data() + pixel * channels;
      for (std::size_t c = 0; c < channels; ++c) out[c] = cell.sample(to.samples.data() + c, to.channels);
    }
  });
  return result;
}

Luma warp(const Luma& to, const Flow& flow) {
  check_sizes(to, flow);
  Luma result{to.width, to.height, std::vector<std::uint8_t>(to.v.size())};
  const std::vector<float> from(to.v.begin(), to.v.end());  // vectors gather no bytes
  const auto width = std::size_t(to.width);
  parallel_for(std::size_t(flow.height), [&](std::size_t y) {
    warp_row(from.data(), to.width, to.height, int(y), &flow.xy[2 * y * width], &result.v[y * width]);
  });
  return result;
}

}  // namespace knotreel::motion
