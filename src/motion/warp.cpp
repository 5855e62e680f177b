#include "knotreel/motion/warp.h"

#include "knotreel/base/parallel.h"
#include "motion/bilinear.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

/// Calls body(pixel, cell) for all pixels: the cell is where the flow leads the pixel.
template <typename Body>
void for_moved_pixels(const Flow& flow, const Body& body) {
  const auto width = std::size_t(flow.width);
  parallel_for(std::size_t(flow.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t pixel = y * width + x;
      const float* d = flow.xy.data() + 2 * pixel;
      body(pixel, cell_at(float(x) + 0.5F + d[0], float(y) + 0.5F + d[1], flow.width, flow.height));
    }
  });
}

}  // namespace

image::Image warp(const image::Image& to, const Flow& flow) {
  check_sizes(to, flow);
  image::Image result{to.width, to.height, to.channels, std::vector<float>(to.samples.size())};
  const auto channels = std::size_t(to.channels);
  for_moved_pixels(flow, [&](std::size_t pixel, const Cell& cell) {
    float* out = result.samples.data() + pixel * channels;
    for (std::size_t c = 0; c < channels; ++c) out[c] = cell.sample(to.samples.data() + c, channels);
  });
  return result;
}

Luma warp(const Luma& to, const Flow& flow) {
  check_sizes(to, flow);
  Luma result{to.width, to.height, std::vector<std::uint8_t>(to.v.size())};
  for_moved_pixels(flow, [&](std::size_t pixel, const Cell& cell) {
    result.v[pixel] = std::uint8_t(cell.sample(to.v.data(), 1) + 0.5F);
  });
  return result;
}

}  // namespace knotreel::motion
