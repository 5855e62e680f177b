#pragma once

#include <cmath>
#include <random>

#include "knotreel/image/image.h"

namespace knotreel::test {

/// Independent samples, multiples of 1/257 in [0,255]: exact in 16 bits.
inline image::Image random_picture(int width, int height, int channels, unsigned seed) {
  image::Image image = image::make_image(width, height, channels);
  std::mt19937 random(seed);
  for (float& sample : image.samples) sample = float(random() % 65536) / 257.0F;
  return image;
}

/// Independent whole samples in 0..255: exact in 8 bits.
inline image::Image random_8bit_picture(int width, int height, int channels, unsigned seed) {
  image::Image image = image::make_image(width, height, channels);
  std::mt19937 random(seed);
  for (float& sample : image.samples) sample = float(random() % 256);
  return image;
}

/// Largest difference between samples; infinite if the shapes differ.
inline double largest_difference(const image::Image& a, const image::Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return INFINITY;
  double largest = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    largest = std::max(largest, std::abs(double{a.samples[i]} - double{b.samples[i]}));
  }
  return largest;
}

}  // namespace knotreel::test
