#include "knotreel/image/background.h"

#include <algorithm>

namespace knotreel::image {

int channels_on(const Background& background, int channels) {
  return background && channels % 2 == 0 ? channels - 1 : channels;
}

void put_on_background(std::vector<float>& samples, int channels, const Background& background) {
  if (channels_on(background, channels) == channels) return;
  const std::array<float, 3>& colour = *background;
  const auto stride = static_cast<std::size_t>(channels);
  const std::size_t colours = stride - 1;
  const float grey = 0.299F * colour[0] + 0.587F * colour[1] + 0.114F * colour[2];
  std::size_t to = 0;
  for (std::size_t from = 0; from < samples.size(); from += stride) {
    const float alpha = std::clamp(samples[from + colours] / 255.0F, 0.0F, 1.0F);
    for (std::size_t c = 0; c < colours; ++c) {
      const float behind = colours == 1 ? grey : colour[c];
      samples[to++] = alpha * samples[from + c] + (1 - alpha) * behind;
    }
  }
  samples.resize(to);
}

Image on_background(Image picture, const Background& background) {
  put_on_background(picture.samples, picture.channels, background);
  picture.channels = channels_on(background, picture.channels);
  return picture;
}

}  // namespace knotreel::image
