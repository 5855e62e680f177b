// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>

#include "knotreel/image/write_image.h"
#include "scene.h"

namespace {

using knotreel::image::Image;
using knotreel::image::make_image;

/// A disc with a soft side and a sharp side on nothing: alpha from 0 to 255, colour under zero alpha is
/// black.
Image badge() {
  Image image = make_image(64, 64, 4);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double r = std::hypot(x + 0.5 - 32, y + 0.5 - 32);
      const double softness = x < 32 ? 0.5 : 8;
      const double alpha = 1 / (1 + std::exp((r - 22) / softness * 2));
      if (alpha < 0.002) continue;
      image.at(x, y, 0) = static_cast<float>(255 * (0.9 - 0.5 * y / 64));
      image.at(x, y, 1) = static_cast<float>(255 * (0.3 + 0.4 * x / 64));
      image.at(x, y, 2) = static_cast<float>(255 * (0.2 + 0.6 * r / 45));
      image.at(x, y, 3) = static_cast<float>(255 * alpha);
    }
  }
  return image;
}

/// A slow ramp that eight bits would show as steps, grey.
Image ramp() {
  Image image = make_image(96, 64, 1);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      image.at(x, y, 0) =
          static_cast<float>(96 + 24 * std::sin(x / 40.0) + 12 * std::cos(y / 25.0 + x / 90.0));
    }
  }
  return image;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_media FOLDER\n";
    return 2;
  }
  try {
    using knotreel::image::SampleType;
    const std::filesystem::path folder = argv[1];
    knotreel::image::write_image(folder / "still-life.png", knotreel::media::still_life(480, 320));
    knotreel::image::write_image(folder / "badge-rgba.png", badge());
    knotreel::image::write_image(folder / "ramp-16bit.png", ramp(), SampleType::u16);
  } catch (const std::exception& e) {
    std::cerr << "make_media: " << e.what() << '\n';
    return 1;
  }
}
