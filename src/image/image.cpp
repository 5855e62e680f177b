// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/image.h"

#include <string>

#include "knotreel/base/error.h"

namespace knotreel::image {

void check_image(const Image& image) {
  const bool has_pixels = image.width >= 1 && image.height >= 1 && image.channels >= 1 && image.channels <= 4;
  if (has_pixels && image.samples.size() == std::size_t(image.height) * image.row_size()) return;
  throw Error(ErrorKind::kInvalidArgument, has_pixels ? "the picture's size and its samples do not agree"
                                                      : "a picture needs pixels, and 1 to 4 channels");
}

Image make_image(int width, int height, int channels) {
  if (width < 1 || height < 1 || channels < 1 || channels > 4) {
    throw Error(ErrorKind::kInvalidArgument, "a picture of " + std::to_string(width) + "x" +
                                                 std::to_string(height) + " pixels and " +
                                                 std::to_string(channels) + " channels cannot exist");
  }
  Image image{width, height, channels, {}};
  if (image.pixel_count() > kMaxPixels) {
    throw Error(ErrorKind::kInvalidArgument, "a picture of " + std::to_string(width) + "x" +
                                                 std::to_string(height) + " has more than " +
                                                 std::to_string(kMaxPixels) + " pixels");
  }
  image.samples.assign(std::size_t(height) * image.row_size(), 0.0F);
  return image;
}

Image widen_channels(const Image& image, int channels) {
  check_image(image);
  if (channels == image.channels) return image;
  Image wide = make_image(image.width, image.height, channels);
  if (wide.colour_channels() < image.colour_channels() || (image.has_alpha() && !wide.has_alpha())) {
    throw Error(ErrorKind::kInvalidArgument, "a picture of " + std::to_string(image.channels) +
                                                 " channels does not fit into " + std::to_string(channels));
  }
  const int colours = image.colour_channels();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < wide.colour_channels(); ++c)
        wide.at(x, y, c) = image.at(x, y, colours == 1 ? 0 : c);
      if (wide.has_alpha()) {
        wide.at(x, y, wide.channels - 1) = image.has_alpha() ? image.at(x, y, image.channels - 1) : 255.0F;
      }
    }
  }
  return wide;
}

}  // namespace knotreel::image
