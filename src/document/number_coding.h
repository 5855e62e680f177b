#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "document/arithmetic.h"
#include "document/bytes.h"

/// Numbers as adaptive bits (docs/format.md, "Coded numbers"). Written once for both directions: with an
/// ArithmeticWriter the functions write what they are given, with an ArithmeticReader they return what they
/// read.
namespace knotreel::document {

/// Size of a number: 0 to 3 are classes of their own, then two classes per octave.
constexpr std::size_t number_class(std::uint64_t v) {
  if (v < 4) return static_cast<std::size_t>(v);
  const auto top = static_cast<std::size_t>(std::bit_width(v)) - 1;
  return 2 * top + ((v >> (top - 1)) & 1);
}
inline constexpr std::size_t kMostClass = 2 * 60 + 1;  ///< numbers are below 2^61

/// How large a number is expected to be.
struct NumberModel {
  std::array<BitModel, 24>
      larger;  ///< by class: whether the number is of a higher one; the last for the rest
};

template <class Coder>
std::uint64_t code_number(Coder& coder, NumberModel& model, std::uint64_t value) {
  std::size_t c = 0;
  const std::size_t of_value = Coder::kWriting ? number_class(value) : 0;
  while (coder.bit(model.larger[std::min(c, model.larger.size() - 1)], c < of_value)) {
    if (++c > kMostClass) malformed("a number is too large");
  }
  if (c < 4) return c;
  const auto extra = static_cast<int>(c / 2) - 1;
  const std::uint64_t base = (2 + c % 2) << extra;
  return base + coder.even_bits(value - base, extra);
}

/// A number that is as likely to be negative as its sign model says.
struct SignedModel {
  NumberModel magnitude;
  BitModel negative;
};

template <class Coder>
std::int64_t code_signed(Coder& coder, NumberModel& magnitude, BitModel& negative, std::int64_t value) {
  const std::uint64_t size =
      value < 0 ? -static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  const auto coded = static_cast<std::int64_t>(code_number(coder, magnitude, size));
  if (coded == 0) return 0;
  return coder.bit(negative, value < 0) ? -coded : coded;
}

template <class Coder>
std::int64_t code_signed(Coder& coder, SignedModel& model, std::int64_t value) {
  return code_signed(coder, model.magnitude, model.negative, value);
}

}  // namespace knotreel::document
