#include "knotreel/features/flat_share.h"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::features {

double flat_share(const image::Image& image) {
  if (image.width < 3 || image.height < 3) return 0;
  const auto channels = static_cast<std::size_t>(image.channels);
  const auto columns = static_cast<std::size_t>(image.width - 2);
  const std::size_t stride = (columns + 2) * channels;
  std::vector<std::size_t> flat(static_cast<std::size_t>(image.height - 2), 0);
  parallel_for(flat.size(), [&](std::size_t row) {
    const float* pixel = image.samples.data() + (row + 1) * stride + channels;
    for (std::size_t x = 0; x < columns; ++x, pixel += channels) {
      bool is_flat = true;
      for (std::size_t c = 0; c < channels; ++c) {
        const float* sample = pixel + c;
        const float along = 2 * *sample - *(sample - channels) - *(sample + channels);
        const float across = 2 * *sample - *(sample - stride) - *(sample + stride);
        is_flat = is_flat && std::abs(along) <= 1 && std::abs(across) <= 1;
      }
      flat[row] += is_flat ? 1 : 0;
    }
  });
  const std::size_t count = std::accumulate(flat.begin(), flat.end(), std::size_t{0});
  return static_cast<double>(count) / static_cast<double>(columns * flat.size());
}

bool is_drawing(const image::Image& image) {
  constexpr double kDrawnShare = 0.6;  // what is left of films by codecs has 0.5 and less
  return flat_share(image) >= kDrawnShare;
}

}  // namespace knotreel::features
