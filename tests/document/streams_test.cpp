#include "document/streams.h"

#include <gtest/gtest.h>

#include <random>

#include "document/crc32c.h"

namespace knotreel::document {
namespace {

TEST(Streams, GiveBackEveryValueUpToTheLimit) {
  std::vector<std::uint64_t> values{0, 1, 31, 32, 33, 63, 64, 1000, (1ull << 40) + 12345, (1ull << 61) - 1,
                                    0, 7};
  std::mt19937_64 random(1);
  for (int i = 0; i < 5000; ++i) values.push_back(random() >> (4 + random() % 60));
  StreamWriter writer(12);
  ByteWriter out;
  writer.integers(out, values);
  writer.integers(out, {});
  writer.integers(out, std::vector<std::uint64_t>(100, 0));
  StreamReader reader;
  ByteReader in(out.view());
  auto symbols = reader.integers(in, values.size());
  for (const std::uint64_t v : values) ASSERT_EQ(symbols.next(), v);
  EXPECT_TRUE(symbols.used_up());
  EXPECT_EQ(symbols.next(), 0u);
  EXPECT_TRUE(reader.integers(in, 0).used_up());
  EXPECT_TRUE(reader.integers(in, 0).used_up());
  EXPECT_EQ(in.remaining(), 0u);
  EXPECT_TRUE(reader.bytes(in, 5).used_up()) << "a stream missing at the end is all zero";
}

TEST(Streams, RefuseMoreThanTheCallerCanUse) {
  StreamWriter writer(12);
  ByteWriter out;
  writer.bytes(out, std::vector<std::uint8_t>(100000, 1));
  EXPECT_LT(out.size(), 100u);
  StreamReader reader;
  ByteReader in(out.view());
  EXPECT_THROW(reader.bytes(in, 99999), Malformed);
}

TEST(Streams, RefuseContentOfAnotherLengthThanStated) {
  StreamWriter writer(12);
  ByteWriter good;
  writer.bytes(good, std::vector<std::uint8_t>(100, 1));
  for (const int change : {-1, 1}) {
    std::vector<std::byte> bad(good.view().begin(), good.view().end());
    bad[0] = static_cast<std::byte>(100 + change);
    StreamReader reader;
    ByteReader in(bad);
    EXPECT_THROW(reader.bytes(in, 1000), Malformed);
  }
}

TEST(Streams, ZigzagInvertsAtTheExtremes) {
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
