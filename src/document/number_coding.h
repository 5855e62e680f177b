// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "document/arithmetic.h"
#include "document/bytes.h"
#include "document/mixing.h"

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

/// How large a number is expected to be: by class whether it is of a higher one, the last for the rest.
template <std::size_t Classes>
struct SizeModel {
  std::array<BitModel, Classes> bits;

  BitModel& larger(std::size_t c) { return bits[std::min(c, Classes - 1)]; }
};
using NumberModel = SizeModel<24>;
/// One of several that are mixed.
using ShortNumberModel = SizeModel<12>;

/// How several models are mixed, by class.
template <std::size_t N>
struct NumberMixer {
  std::array<Mixer<N>, 12> mixers;
};

/// What a NumberModel and some ShortNumberModels say together.
template <std::size_t Short>
class MixedNumber {
 public:
  MixedNumber(NumberModel& first, const std::array<ShortNumberModel*, Short>& rest,
              NumberMixer<Short + 1>& mixer)
      : first_(first), rest_(rest), mixer_(mixer) {}

  MixedBit<Short + 1> larger(std::size_t c) const {
    std::array<BitModel*, Short + 1> bits;
    for (std::size_t i = 0; i < Short; ++i) bits[i] = &rest_[i]->larger(c);
    bits[Short] = &first_.larger(c);
    return {bits, mixer_.mixers[std::min(c, mixer_.mixers.size() - 1)]};
  }

 private:
  NumberModel& first_;
  std::array<ShortNumberModel*, Short> rest_;
  NumberMixer<Short + 1>& mixer_;
};

/// @param model  a NumberModel or a MixedNumber.
template <class Coder, class Model>
std::uint64_t code_number(Coder& coder, Model&& model, std::uint64_t value) {
  std::size_t c = 0;
  const std::size_t of_value = Coder::kWriting ? number_class(value) : 0;
  while (coder.bit(model.larger(c), c < of_value)) {
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

/// @param magnitude  a NumberModel or a MixedNumber. @param negative  a BitModel or a MixedBit.
template <class Coder, class Magnitude, class Negative>
std::int64_t code_signed(Coder& coder, Magnitude&& magnitude, Negative&& negative, std::int64_t value) {
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
