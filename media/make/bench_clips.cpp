// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_clips.h"

#include <algorithm>
#include <cstdint>

#include "scenes.h"

namespace knotreel::media {
namespace {

constexpr int kShotFrames = kBenchClipRate / 2;

Colour moving_scene(double x, double y, double t) {
  return balls_scene(x, y, {t, t, t}, {0.8 * t, 0.1 * t});
}

/// Shots differ in scene, time and place.
Colour cuts_scene(double x, double y, int frame) {
  const int shot = frame / kShotFrames;
  const double t = double(frame % kShotFrames) / kBenchClipRate + 0.6 * (shot % 7);
  const double moved = x + 2.3 * (shot % 5);
  return shot % 2 == 0 ? moving_scene(moved, y, t) : hills_scene(moved, y, t);
}

Colour scene_of(const std::string& name, double x, double y, int frame) {
  const double t = double(frame) / kBenchClipRate;
  if (name == "static") return balls_scene(x, y, {0.4, 0.4, t}, {});
  if (name == "pan") return balls_scene(x + 1.2 * t, y + 0.2 * t, {0.4, 0.4, 0.4}, {});
  if (name == "cuts") return cuts_scene(x, y, frame);
  if (name == "cartoon") return cartoon_scene(x, y, t);
  return moving_scene(x, y, t);
}

/// Whole numbers that look like chance: the finaliser of MurmurHash3.
std::uint32_t scrambled(std::uint32_t n) {
  n = (n ^ (n >> 16)) * 0x85ebca6bU;
  n = (n ^ (n >> 13)) * 0xc2b2ae35U;
  return n ^ (n >> 16);
}

/// Nearly normal, with a deviation of 6 levels, the same for all channels of a pixel.
void add_grain(image::Image& image, int frame) {
  constexpr float kDeviation = 6;
  constexpr float kByteDeviation = 147.8F;  // of the sum of four bytes at random
  const std::uint32_t seed = scrambled(std::uint32_t(frame) + 1);
  for (std::size_t i = 0; i < image.samples.size(); i += 3) {
    const std::uint32_t bits = scrambled(seed + std::uint32_t(i));
    const auto sum = float((bits & 255) + (bits >> 8 & 255) + (bits >> 16 & 255) + (bits >> 24));
    const float grain = (sum - 510) * (kDeviation / kByteDeviation);
    for (std::size_t c = 0; c < 3; ++c) {
      image.samples[i + c] = std::clamp(image.samples[i + c] + grain, 0.0F, 255.0F);
    }
  }
}

}  // namespace

const std::vector<std::string>& bench_clip_names() {
  static const std::vector<std::string> names{"static", "pan", "cuts", "cartoon", "noise"};
  return names;
}

image::Image bench_clip_frame(const std::string& name, int width, int height, int frame) {
  // Pixels stay square: narrower pictures show less of the scene.
  const double shown = 9.0 * width / height;
  image::Image image = draw_scene(width, height, 2, [&](double u, double v) {
    return scene_of(name, 8 + shown * (u - 0.5), 9 * v, frame);
  });
  if (name == "noise") add_grain(image, frame);
  return image;
}

}  // namespace knotreel::media
