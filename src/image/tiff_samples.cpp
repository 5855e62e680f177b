// SPDX-License-Identifier: GPL-3.0-or-later
#include "tiff_samples.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace knotreel::image {
namespace {

template <typename Stored>
Stored stored_at(const std::byte* row, std::size_t index) {
  Stored value;
  std::memcpy(&value, row + index * sizeof value, sizeof value);
  return value;
}

template <typename Stored>
double whole_bytes(const std::byte* row, std::size_t index) {
  return static_cast<double>(stored_at<Stored>(row, index));
}

/// IEEE 754 binary16.
double half_float(const std::byte* row, std::size_t index) {
  const auto bits = stored_at<std::uint16_t>(row, index);
  const int exponent = bits >> 10 & 31;
  const int fraction = bits & 1023;
  double value = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  if (exponent == 31)
    value =
        fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  return bits >> 15 != 0 ? -value : value;
}

template <int kBits>
double packed(const std::byte* row, std::size_t index) {
  unsigned value = 0;
  for (std::size_t bit = index * kBits; bit < (index + 1) * kBits; ++bit)
    value = value << 1 | (std::to_integer<unsigned>(row[bit / 8]) >> (7 - bit % 8) & 1U);
  return value;
}

template <double (*kRead)(const std::byte* row, std::size_t index)>
void unpack(const std::byte* row, SamplesOfRow from, std::size_t count, double* to, std::size_t to_step) {
  for (std::size_t i = 0; i < count; ++i) to[i * to_step] = kRead(row, from.first + i * from.step);
}

UnpackSamples unpacker_of_floats(int bits) {
  switch (bits) {
    case 16:
      return unpack<half_float>;
    case 32:
      return unpack<whole_bytes<float>>;
    case 64:
      return unpack<whole_bytes<double>>;
    default:
      return nullptr;
  }
}

}  // namespace

UnpackSamples tiff_unpacker(int bits, bool floats) {
  if (floats) return unpacker_of_floats(bits);
  switch (bits) {
    case 1:
      return unpack<packed<1>>;
    case 2:
      return unpack<packed<2>>;
    case 4:
      return unpack<packed<4>>;
    case 8:
      return unpack<whole_bytes<std::uint8_t>>;
    case 10:
      return unpack<packed<10>>;
    case 12:
      return unpack<packed<12>>;
    case 14:
      return unpack<packed<14>>;
    case 16:
      return unpack<whole_bytes<std::uint16_t>>;
    case 32:
      return unpack<whole_bytes<std::uint32_t>>;
    default:
      return nullptr;
  }
}

}  // namespace knotreel::image
