#include <gtest/gtest.h>

#include <random>

#include "document/crc32c.h"
#include "document/number_coding.h"

namespace knotreel::document {
namespace {

constexpr std::uint64_t kSeed = 31;

TEST(Coding, GivesBackEveryNumberUpToTheLimit) {
  std::vector<std::int64_t> values{
      0, 1, -1, 3, 4, -5, 6, 7, 8, (std::int64_t{1} << 60) + 12345, -((std::int64_t{1} << 61) - 1), 0};
  std::mt19937_64 random(kSeed);
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
  std::mt19937_64 random(kSeed);
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
