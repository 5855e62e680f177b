// SPDX-License-Identifier: GPL-3.0-or-later
#include "clip.h"
#include "scenes.h"

namespace knotreel::media {

image::Image clip_frame(int width, int height, int frame) {
  const bool second = frame >= kClipFrames / 2;
  const double t = double(frame % (kClipFrames / 2)) / kClipRate;
  return draw_scene(width, height, 3, [=](double u, double v) {
    return second ? hills_scene(16 * u, 9 * v, t) : balls_scene(16 * u, 9 * v, {t, t, t}, {0.8 * t, 0.1 * t});
  });
}

}  // namespace knotreel::media
