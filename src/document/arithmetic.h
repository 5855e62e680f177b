// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Binary arithmetic coding with adaptive probabilities (docs/format.md, "Coded bits"). What the next bit
/// probably is costs a small part of a bit, so a frame pays for its surprises only.
namespace knotreel::document {

/// Probability of a bit that learns from the bits so far: fast at first, then ever slower.
class BitModel {
 public:
  /// Chance of a one in 1/65536, never so near to 0 or 1 that the coder loses its place.
  std::uint32_t one() const { return one_; }
  void learn(bool bit) {
    const std::int32_t target = bit ? 65536 - kLeast : kLeast;
    one_ = static_cast<std::uint16_t>(one_ + (target - one_) * 2 / (2 * seen_ + 3));
    if (seen_ < kMemory) ++seen_;
  }

 private:
  static constexpr std::int32_t kLeast = 24;
  static constexpr std::int32_t kMemory = 160;

  std::uint16_t one_ = 32768;
  std::uint16_t seen_ = 0;
};

/// Where [low, high] is cut for a bit: ones take the lower part.
inline std::uint32_t cut(std::uint32_t low, std::uint32_t high, std::uint32_t one) {
  return low + static_cast<std::uint32_t>((std::uint64_t{high - low} * one) >> 16);
}

class ArithmeticWriter {
 public:
  static constexpr bool kWriting = true;

  /// @param model  a BitModel or what has its functions. @return the bit, so that writer and reader can share
  /// their code.
  template <class Model>
  bool bit(Model&& model, bool value) {
    narrow(cut(low_, high_, model.one()), value);
    model.learn(value);
    return value;
  }
  /// `count` bits, highest first, whose chances are even.
  std::uint64_t even_bits(std::uint64_t value, int count);

  /// The shortest bytes that decode to the bits written, the reader taking zeros for what is missing.
  std::vector<std::byte> finish();

 private:
  void narrow(std::uint32_t middle, bool value);

  std::vector<std::byte> bytes_;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xffffffff;
};

/// Reads bits from data that may be hostile: any bytes are bits, without end.
class ArithmeticReader {
 public:
  static constexpr bool kWriting = false;

  explicit ArithmeticReader(std::span<const std::byte> bytes);

  /// The second argument is what a writer would be given; it is not used.
  template <class Model>
  bool bit(Model&& model, bool = false) {
    const bool value = narrow(cut(low_, high_, model.one()));
    model.learn(value);
    return value;
  }
  std::uint64_t even_bits(std::uint64_t, int count);

  /// @throws Malformed if anything but zeros follows what was read.
  void require_end() const;

 private:
  bool narrow(std::uint32_t middle);
  std::uint8_t next_byte();

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xffffffff;
  std::uint32_t code_ = 0;
};

}  // namespace knotreel::document
