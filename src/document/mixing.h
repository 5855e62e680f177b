// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "document/arithmetic.h"

/// What several models say of one bit, weighed by how right each has been (docs/format.md, "Mixed bits";
/// after the logistic mixing of PAQ). Integers only, so that every machine decodes what another has encoded.
namespace knotreel::document {

/// Chances in 1/4096 at x = -2048, -1920, ..., 2048.
inline constexpr std::array<std::int32_t, 33> kSquashed{
    1,    2,    3,    6,    10,   16,   27,   45,   73,   120,  194,  310,  488,  747,  1101, 1546, 2047,
    2549, 2994, 3348, 3607, 3785, 3901, 3975, 4022, 4050, 4068, 4079, 4085, 4089, 4092, 4093, 4094};

/// About 4096 / (1 + exp(-x / 256)); x is clamped to -2047 to 2047.
constexpr std::int32_t squash(std::int64_t x) {
  const auto bounded = static_cast<std::int32_t>(std::clamp<std::int64_t>(x, -2047, 2047)) + 2048;
  const auto at = static_cast<std::size_t>(bounded >> 7);
  const std::int32_t part = bounded & 127;
  return (kSquashed[at] * (128 - part) + kSquashed[at + 1] * part + 64) >> 7;
}

/// The least x whose squash() is at least a chance of 0 to 4095 in 1/4096; 2047 if there is none.
inline constexpr std::array<std::int16_t, 4096> kStretched = [] {
  std::array<std::int16_t, 4096> table{};
  std::int16_t x = -2047;
  for (std::int32_t chance = 0; chance < 4096; ++chance) {
    while (x < 2047 && squash(x) < chance) ++x;
    table[static_cast<std::size_t>(chance)] = x;
  }
  return table;
}();

/// Weights of the models.
template <std::size_t N>
class Mixer {
 public:
  using Stretched = std::array<std::int32_t, N>;  ///< what the models say

  Mixer() { weight_.fill(kSum / static_cast<std::int32_t>(N)); }

  /// Chance of a one in 1/4096, 1 to 4094.
  std::int32_t one(const Stretched& said) const {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < N; ++i) sum += std::int64_t{weight_[i]} * said[i];
    return squash(sum >> 16);
  }
  /// @param one  as told before the bit was known.
  void learn(const Stretched& said, std::int32_t one, bool bit) {
    const std::int32_t error = (bit ? 4096 : 0) - one;
    for (std::size_t i = 0; i < N; ++i) {
      weight_[i] = std::clamp(weight_[i] + ((said[i] * error + 1024) >> 11), -kMost, kMost);
    }
  }

 private:
  static constexpr std::int32_t kSum = 78643;      ///< of the weights at first: 1.2 in 1/65536
  static constexpr std::int32_t kMost = 16 << 16;  ///< bound of a weight

  std::array<std::int32_t, N> weight_;
};

/// One bit as a coder takes it, once, like a BitModel.
template <std::size_t N>
class MixedBit {
 public:
  MixedBit(const std::array<BitModel*, N>& models, Mixer<N>& mixer) : models_(models), mixer_(mixer) {
    for (std::size_t i = 0; i < N; ++i) said_[i] = kStretched[models_[i]->one() >> 4];
    one_ = mixer_.one(said_);
  }

  std::uint32_t one() const { return static_cast<std::uint32_t>(one_) << 4; }
  void learn(bool bit) {
    mixer_.learn(said_, one_, bit);
    for (BitModel* m : models_) m->learn(bit);
  }

 private:
  std::array<BitModel*, N> models_;
  Mixer<N>& mixer_;
  typename Mixer<N>::Stretched said_{};
  std::int32_t one_ = 0;
};

}  // namespace knotreel::document
