// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdio>

#include "knotreel/image/metrics.h"
#include "knotreel/raster/render.h"
#include "knotreel/vectorize/vectorize.h"

// Vectorizes a gradient, draws it, and compares: every layer of the library is linked.
int main() {
  knotreel::image::Image picture = knotreel::image::make_image(48, 32, 3);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x) picture.at(x, y, 0) = static_cast<float>(3 * x + 2 * y);
  }
  const auto made = knotreel::vectorize::vectorize_picture(picture);
  const knotreel::raster::Renderer renderer(made.model, {});
  knotreel::image::Image drawn =
      knotreel::image::make_image(renderer.width(), renderer.height(), renderer.channels());
  renderer.rows(0, drawn.height, drawn.samples);
  const double mec = knotreel::image::compare_images(picture, drawn).mec;
  std::printf("consumer: MEC %.3f\n", mec);
  return mec < 5 ? 0 : 1;
}
