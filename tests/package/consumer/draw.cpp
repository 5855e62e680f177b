// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "knotreel/document/reader.h"
#include "knotreel/image/image.h"
#include "knotreel/raster/render.h"

// Reads a document and draws it: nothing is linked that makes one.
int main(int, char** argv) {
  auto reader = knotreel::document::Reader::open(argv[1]);
  const knotreel::raster::Renderer renderer(reader.read(0), {});
  knotreel::image::Image drawn =
      knotreel::image::make_image(renderer.width(), renderer.height(), renderer.channels());
  renderer.rows(0, drawn.height, drawn.samples);
  std::printf("draw: %d x %d\n", drawn.width, drawn.height);
  return drawn.width == 8 && drawn.height == 4 ? 0 : 1;
}
