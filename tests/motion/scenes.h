// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"
#include "knotreel/motion/flow.h"

/// Pictures whose motion is known, for tests of motion.
namespace knotreel::motion::testing {

/// A smooth pattern without repetition that is defined everywhere, about 40 to 220; seeds give unrelated
/// ones.
class Texture {
 public:
  explicit Texture(unsigned seed = 1) {
    std::mt19937 random(seed);
    const auto unit = [&] { return double(random()) / double(std::mt19937::max()); };
    for (Wave& wave : waves_) {
      const double length = 9 * std::pow(6.0, unit());
      const double angle = 6.2831853 * unit();
      wave = {6.2831853 / length * Vec2{std::cos(angle), std::sin(angle)}, 6.2831853 * unit()};
    }
  }
  double operator()(Vec2 p) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(dot(wave.frequency, p) + wave.phase);
    return 130 + 90 * std::tanh(0.35 * sum);
  }

 private:
  struct Wave {
    Vec2 frequency;
    double phase;
  };
  std::array<Wave, 14> waves_;
};

/// A grey picture of a function of the centres of pixels.
template <typename Value>
image::Image draw(int width, int height, const Value& value) {
  image::Image image = image::make_image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at(x, y, 0) = float(value(Vec2{x + 0.5, y + 0.5}));
  }
  return image;
}

/// The texture after it has moved by d.
inline image::Image moved_texture(int width, int height, Vec2 d, unsigned seed = 1) {
  const Texture texture(seed);
  return draw(width, height, [&](Vec2 p) { return texture(p - d); });
}

/// Independent normal noise, clamped to 0..255.
inline image::Image with_noise(image::Image image, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, float(sigma));
  for (float& sample : image.samples) sample = std::clamp(sample + noise(random), 0.0F, 255.0F);
  return image;
}

/// Every sample times `gain` plus `offset`, clamped to 0..255.
inline image::Image in_other_light(image::Image image, double gain, double offset) {
  for (float& sample : image.samples) {
    sample = float(std::clamp(gain * double{sample} + offset, 0.0, 255.0));
  }
  return image;
}

/// The same displacement everywhere.
inline Flow constant_flow(int width, int height, Vec2 d) {
  Flow flow{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    flow.xy.push_back(float(d.x));
    flow.xy.push_back(float(d.y));
  }
  return flow;
}

inline double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace knotreel::motion::testing
