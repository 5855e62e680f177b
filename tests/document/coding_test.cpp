// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "document/crc32c.h"
#include "document/number_coding.h"

namespace knotreel::document {
namespace {

constexpr std::uint64_t kCodingSeed = 31;

TEST(Coding, GivesBackEveryNumberUpToTheLimit) {
  std::vector<std::int64_t> values{
      0, 1, -1, 3, 4, -5, 6, 7, 8, (std::int64_t{1} << 60) + 12345, -((std::int64_t{1} << 61) - 1), 0};
  std::mt19937_64 random(kCodingSeed);
  for (int i = 0; i < 5000; ++i) {
    const auto size = static_cast<std::int64_t>(random() >> (4 + random() % 60));
    values.push_back(random() % 2 == 0 ? size : -size);
  }
  ArithmeticWriter out;
  SignedModel written;
  for (const std::int64_t v : values) code_signed(out, written, v);
  const std::vector<std::byte> bytes = out.finish();
  ArithmeticReader in(bytes);
  SignedModel read;
  for (const std::int64_t v : values) ASSERT_EQ(code_signed(in, read, 0), v);
  EXPECT_NO_THROW(in.require_end());
}

TEST(Coding, AnyBitsOfAnyChanceComeBack) {
  std::mt19937_64 random(kCodingSeed);
  for (int length = 0; length < 300; ++length) {
    for (const unsigned chance : {0u, 1u, 50u, 99u, 100u}) {
      std::vector<bool> bits;
      for (int i = 0; i < length; ++i) bits.push_back(random() % 100 < chance);
      ArithmeticWriter out;
      std::array<BitModel, 3> written;
      for (std::size_t i = 0; i < bits.size(); ++i) out.bit(written[i % 3], bits[i]);
      const std::vector<std::byte> bytes = out.finish();
      ArithmeticReader in(bytes);
      std::array<BitModel, 3> read;
      for (std::size_t i = 0; i < bits.size(); ++i) ASSERT_EQ(in.bit(read[i % 3]), bits[i]);
      EXPECT_NO_THROW(in.require_end());
    }
  }
}

TEST(Coding, WhatIsExpectedCostsNextToNothing) {
  ArithmeticWriter out;
  NumberModel model;
  for (int i = 0; i < 100000; ++i) code_number(out, model, 0);
  EXPECT_LT(out.finish().size(), 50u);
}

/// docs/format.md, "Mixed bits", word by word.
struct PlainMixer {
  std::vector<std::int64_t> weights;

  static std::int64_t floor_of(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(a) / static_cast<double>(b)));
  }
  static std::int64_t squashed(std::int64_t x) {
    const std::int64_t t[] = {1,    2,    3,    6,    10,   16,   27,   45,   73,   120,  194,
                              310,  488,  747,  1101, 1546, 2047, 2549, 2994, 3348, 3607, 3785,
                              3901, 3975, 4022, 4050, 4068, 4079, 4085, 4089, 4092, 4093, 4094};
    const std::int64_t y = std::max<std::int64_t>(-2047, std::min<std::int64_t>(2047, x)) + 2048;
    const std::int64_t i = floor_of(y, 128);
    const std::int64_t r = y - 128 * i;
    return floor_of(t[i] * (128 - r) + t[i + 1] * r + 64, 128);
  }
  static std::int64_t stretched(std::int64_t p) {
    std::int64_t x = -2047;
    while (squashed(x) < p) ++x;
    return x;
  }
  /// @return p
  std::int64_t read(const std::vector<std::int64_t>& ones, bool bit) {
    if (weights.empty()) weights.assign(ones.size(), floor_of(78643, static_cast<std::int64_t>(ones.size())));
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < ones.size(); ++i) sum += weights[i] * stretched(floor_of(ones[i], 16));
    const std::int64_t p = squashed(floor_of(sum, 65536));
    for (std::size_t i = 0; i < ones.size(); ++i) {
      const std::int64_t w =
          weights[i] + floor_of(stretched(floor_of(ones[i], 16)) * (bit ? 4096 - p : -p) + 1024, 2048);
      weights[i] = std::max<std::int64_t>(-1048576, std::min<std::int64_t>(1048576, w));
    }
    return p;
  }
};

TEST(Coding, MixedBitsAreThoseOfTheFormat) {
  std::mt19937_64 random(kCodingSeed);
  std::array<BitModel, 6> models;
  Mixer<3> mixer;
  PlainMixer plain;
  for (int i = 0; i < 4000; ++i) {
    const bool hidden = random() % 5 == 0;
    // Two models that know different things, and one that knows nothing.
    const std::array<BitModel*, 3> asked{&models[hidden ? 1 : 0], &models[2 + (i / 500) % 2],
                                         &models[4 + random() % 2]};
    const bool bit = (random() % 100 < 97) == hidden || (i / 500 % 2 == 1 && random() % 3 == 0);
    std::vector<std::int64_t> ones;
    for (const BitModel* m : asked) ones.push_back(m->one());
    MixedBit<3> mixed(asked, mixer);
    ASSERT_EQ(mixed.one(), 16 * plain.read(ones, bit)) << i;
    mixed.learn(bit);
  }
}

TEST(Coding, AMixtureIsAsGoodAsTheBestOfItsModels) {
  std::mt19937_64 random(kCodingSeed);
  std::vector<std::pair<bool, bool>> bits;  // what one model knows, the bit
  for (int i = 0; i < 20000; ++i) {
    const bool known = random() % 2 == 0;
    bits.emplace_back(known, (random() % 20 == 0) != known);
  }
  std::array<BitModel, 2> informed;
  ArithmeticWriter best;
  for (const auto& [known, bit] : bits) best.bit(informed[known ? 1 : 0], bit);

  const auto mix = [&](auto& coder) {
    std::array<BitModel, 4> models;
    Mixer<3> mixer;
    bool same = true;
    for (const auto& [known, bit] : bits) {
      same =
          coder.bit(MixedBit<3>({&models[0], &models[known ? 2 : 1], &models[3]}, mixer), bit) == bit && same;
    }
    return same;
  };
  ArithmeticWriter out;
  mix(out);
  const std::vector<std::byte> bytes = out.finish();
  ArithmeticReader in(bytes);
  EXPECT_TRUE(mix(in));
  EXPECT_NO_THROW(in.require_end());
  EXPECT_LT(static_cast<double>(bytes.size()), 1.02 * static_cast<double>(best.finish().size()));
}

TEST(Coding, MixedNumbersComeBackWhateverTheyAre) {
  std::mt19937_64 random(kCodingSeed);
  std::vector<std::int64_t> values;
  for (int i = 0; i < 5000; ++i) {
    const auto size = static_cast<std::int64_t>(random() >> (4 + random() % 60));
    values.push_back(random() % 2 == 0 ? size : -size);
  }
  const auto code = [&](auto& coder) {
    NumberModel first;
    std::array<ShortNumberModel, 4> rest;
    NumberMixer<3> mixer;
    std::array<BitModel, 2> signs;
    Mixer<2> sign_mixer;
    std::vector<std::int64_t> result;
    for (std::size_t i = 0; i < values.size(); ++i) {
      MixedNumber<2> magnitude(first, {&rest[i % 2], &rest[2 + i % 2]}, mixer);
      result.push_back(
          code_signed(coder, magnitude, MixedBit<2>({&signs[0], &signs[1]}, sign_mixer), values[i]));
    }
    return result;
  };
  ArithmeticWriter out;
  code(out);
  const std::vector<std::byte> bytes = out.finish();
  ArithmeticReader in(bytes);
  EXPECT_EQ(code(in), values);
  EXPECT_NO_THROW(in.require_end());
}

TEST(Coding, TrailingZerosAreNotStoredAndOtherBytesBehindTheEndAreRefused) {
  ArithmeticWriter out;
  BitModel model;
  for (int i = 0; i < 100; ++i) out.bit(model, i % 7 == 0);
  std::vector<std::byte> bytes = out.finish();
  ASSERT_FALSE(bytes.empty());
  EXPECT_NE(bytes.back(), std::byte{0});
  const auto ends = [](const std::vector<std::byte>& data) {
    ArithmeticReader in(data);
    BitModel read;
    for (int i = 0; i < 100; ++i) EXPECT_EQ(in.bit(read), i % 7 == 0);
    in.require_end();
  };
  bytes.resize(bytes.size() + 9);
  EXPECT_NO_THROW(ends(bytes));
  bytes.back() = std::byte{1};
  EXPECT_THROW(ends(bytes), Malformed);
}

TEST(Coding, ANumberWithoutEndIsRefused) {
  // Zero bytes are ones, and ones say "larger" for ever.
  const std::vector<std::byte> nothing;
  ArithmeticReader in(nothing);
  NumberModel model;
  EXPECT_THROW(code_number(in, model, 0), Malformed);
}

TEST(Coding, ZigzagInvertsAtTheExtremes) {
  for (const std::int64_t v : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1}, INT64_MAX, INT64_MIN}) {
    EXPECT_EQ(unzigzag(zigzag(v)), v);
  }
}

TEST(Crc32c, MatchesThePublishedCheckValue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32c(std::as_bytes(std::span(text))), 0xE3069283u);
}

}  // namespace
}  // namespace knotreel::document
