// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "document/frame_models.h"

/// Differences from predictions (docs/format.md, "Coded differences").
namespace knotreel::document {

/// Towards minus infinity.
constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - ((a % b != 0 && a < 0) ? 1 : 0);
}

/// The differences coded so far near the next one: what size and sign to expect.
struct Around {
  std::int64_t sum = 0;   ///< of differences
  std::int64_t size = 0;  ///< of their magnitudes
  std::int64_t count = 0;

  void add(std::int64_t difference) {
    sum += difference;
    size += difference < 0 ? -difference : difference;
    ++count;
  }
  /// Twice the mean, towards zero.
  std::int64_t twice_mean() const { return count == 0 ? 0 : 2 * sum / count; }
  void add(const Around& other) {
    sum += other.sum;
    size += other.size;
    count += other.count;
  }
};

/// Which model of magnitudes is asked: that of the size that those around make one expect.
inline std::size_t expected_size(const Around& around) {
  constexpr std::size_t kUnknown = ResidualModels::kSizes - 1;
  if (around.count == 0) return kUnknown;
  return std::min(kUnknown - 1, number_class(static_cast<std::uint64_t>(2 * around.size / around.count)));
}

/// 0: zero, 1: positive, 2: negative.
constexpr std::size_t sign_class(std::int64_t v) {
  return v == 0 ? 0 : v > 0 ? 1 : 2;
}

/// Class of a magnitude among few.
constexpr std::size_t small_class(std::int64_t v) {
  return std::min(kSmallClasses - 1, number_class(static_cast<std::uint64_t>(v < 0 ? -v : v)));
}

/// Sign and size together.
constexpr std::size_t signed_class(std::int64_t v) {
  return sign_class(v) * kSmallClasses + small_class(v);
}

/// Class of twice an area in 1/256 px^2: octaves from 1/16 px^2 on.
constexpr std::size_t area_class(std::int64_t twice) {
  const auto size = static_cast<std::uint64_t>(twice < 0 ? -twice : twice);
  return std::min(kAreaClasses - 1, static_cast<std::size_t>(std::bit_width(size >> 5)));
}

/// Sets `value` to prediction + the difference read, or writes the difference. @return the difference.
template <class Coder, class Magnitude, class Negative>
std::int64_t code_difference(Coder& coder, Magnitude&& magnitude, Negative&& negative, std::int64_t& value,
                             std::int64_t prediction) {
  const std::int64_t difference =
      code_signed(coder, magnitude, negative, Coder::kWriting ? value - prediction : 0);
  // Values stay below 2^40 or are refused before they predict another, differences are below 2^61.
  constexpr std::int64_t kBound = std::int64_t{1} << 40;
  const std::int64_t result = prediction + difference;
  if (result < -kBound || result > kBound) malformed("a number is out of range");
  if constexpr (!Coder::kWriting) value = result;
  return difference;
}

template <class Coder>
std::int64_t code_residual(Coder& coder, ResidualModels& models, const Around& around, std::int64_t& value,
                           std::int64_t prediction) {
  return code_difference(coder, models.magnitude[expected_size(around)],
                         models.negative[sign_class(around.sum)], value, prediction);
}

}  // namespace knotreel::document
