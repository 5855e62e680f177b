// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string_view>

#include "document/bytes.h"
#include "document/container.h"
#include "document/reseal.h"
#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;
using Bytes = std::vector<std::byte>;

constexpr std::uint64_t kCorruptionSeed = 4711;

enum class Outcome { kRead, kRefused, kWrong };

/// Opens a document and reads all its frames. The only exception that may come is Error{kInput} with one
/// line.
Outcome try_document(Bytes bytes, std::string* message = nullptr) {
  try {
    Reader reader = Reader::open(std::move(bytes), "some/file.tcb");
    for (std::size_t f = 0; f < reader.frame_count(); ++f) reader.read(f);
    return Outcome::kRead;
  } catch (const Error& e) {
    const std::string text = e.what();
    if (message) *message = text;
    const bool says_all = text.starts_with("some/file.tcb: ") && text.find("at byte") != std::string::npos &&
                          text.find('\n') == std::string::npos;
    return e.kind() == ErrorKind::kInput && says_all ? Outcome::kRefused : Outcome::kWrong;
  } catch (...) {
    return Outcome::kWrong;
  }
}

Bytes small_document() {
  FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 12, 1, kCorruptionSeed), 2, 2, kCorruptionSeed);
  std::vector<FrameModel> frames{model};
  frames.push_back(testing::successor(model, 0, kCorruptionSeed));
  frames.push_back(testing::successor(frames.back(), 2, kCorruptionSeed));
  return testing::write_document(frames);
}

Bytes sequence(int knots, int degree) {
  std::vector<FrameModel> frames{testing::random_model(
      testing::random_mesh(160, 120, knots, 3, kCorruptionSeed), degree, 3, kCorruptionSeed)};
  for (std::uint64_t f = 1; f < 4; ++f) {
    frames.push_back(testing::successor(frames.back(), f % 2 == 0 ? 0 : 5, kCorruptionSeed + f));
  }
  return testing::write_document(frames);
}

Bytes flipped(Bytes bytes, std::size_t at, int bit) {
  bytes[at] ^= static_cast<std::byte>(1 << bit);
  return bytes;
}

TEST(Corruption, EveryBitFlipOfASmallDocumentIsFound) {
  const Bytes good = small_document();
  ASSERT_EQ(try_document(good), Outcome::kRead);
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      ASSERT_EQ(try_document(flipped(good, at, bit)), Outcome::kRefused) << "byte " << at << " bit " << bit;
    }
  }
}

TEST(Corruption, EveryBitFlipBeneathTheChecksumsIsHarmless) {
  const Bytes good = small_document();
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bad = flipped(good, at, bit);
      testing::reseal(bad);
      ASSERT_NE(try_document(bad), Outcome::kWrong) << "byte " << at << " bit " << bit;
    }
  }
}

/// One of many ways to damage a document; the outcome is neither the document nor its beginning.
Bytes damaged(const Bytes& good, std::mt19937_64& random) {
  Bytes bad = good;
  // Eight bytes off the end, where a missing byte cannot be told from a truncation (see recovery_test.cpp).
  const std::size_t at = random() % (bad.size() - 8);
  const auto place = bad.begin() + static_cast<std::ptrdiff_t>(at);
  switch (random() % 4) {
    case 0:
      *place ^= static_cast<std::byte>(1 + random() % 255);
      break;
    case 1:
      *place ^= std::byte{1};
      std::generate_n(place + 1, random() % 8, [&] { return static_cast<std::byte>(random()); });
      break;
    case 2:
      bad.erase(place);
      break;
    default:
      bad.insert(place, static_cast<std::byte>(random()));
  }
  return bad;
}

TEST(Corruption, HundredThousandDamagedCopiesOfALargerDocument) {
  const Bytes good = testing::write_document({testing::picture_model(320, 240, 1000, kCorruptionSeed)});
  std::mt19937_64 random(kCorruptionSeed);
  for (int i = 0; i < 100000; ++i) {
    const Bytes bad = damaged(good, random);
    if (bad == good) continue;
    ASSERT_EQ(try_document(bad), Outcome::kRefused) << "case " << i;
  }
}

TEST(Corruption, DamagedCopiesOfASequence) {
  const Bytes good = sequence(60, 2);
  std::mt19937_64 random(kCorruptionSeed);
  for (int i = 0; i < 10000; ++i) {
    const Bytes bad = damaged(good, random);
    if (bad == good) continue;
    ASSERT_EQ(try_document(bad), Outcome::kRefused) << "case " << i;
  }
}

TEST(Corruption, DamageBeneathTheChecksumsIsHarmless) {
  for (int degree = 1; degree <= 3; ++degree) {
    const Bytes good = sequence(60, degree);
    std::mt19937_64 random(kCorruptionSeed);
    int refused = 0;
    constexpr int kCases = 3000;
    for (int i = 0; i < kCases; ++i) {
      Bytes bad = good;
      for (std::uint64_t flips = 1 + random() % 3; flips > 0; --flips) {
        bad[random() % bad.size()] ^= static_cast<std::byte>(1 << random() % 8);
      }
      testing::reseal(bad);
      const Outcome outcome = try_document(bad);
      ASSERT_NE(outcome, Outcome::kWrong) << "case " << i;
      refused += outcome == Outcome::kRefused ? 1 : 0;
    }
    EXPECT_GT(refused, kCases / 4);
    EXPECT_LT(refused, kCases) << "some damage changes numbers only";
  }
}

TEST(Corruption, EdgesSofterThanAllowedAreRefused) {
  FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kCorruptionSeed), 2, 3, kCorruptionSeed);
  model.frame = 0;
  model.pts = 0;
  model.edge_softness = 0;
  const Bytes hard = testing::write_document({model});
  model.edge_softness = 64 * document::kEdgeSoftnessStep;
  Bytes soft = testing::write_document({model});
  // The two differ first in the length of the frame, then in its flags; frame number and time are behind.
  const std::string_view type = "FRAM";
  const auto frame = std::search(soft.begin(), soft.end(), type.begin(), type.end(),
                                 [](std::byte b, char c) { return b == static_cast<std::byte>(c); });
  const auto softness = frame + 16 + 3;
  ASSERT_EQ(soft.size(), hard.size() + 1);
  ASSERT_EQ(*softness, std::byte{64});
  ASSERT_EQ(try_document(soft), Outcome::kRead);
  *softness = std::byte{65};
  testing::reseal(soft);
  EXPECT_EQ(try_document(soft), Outcome::kRefused);
}

TEST(Corruption, RefusesForeignFilesByName) {
  std::string message;
  EXPECT_EQ(try_document({}, &message), Outcome::kRefused);
  EXPECT_NE(message.find("empty"), std::string::npos);
  EXPECT_EQ(try_document(Bytes(1000, std::byte{'x'}), &message), Outcome::kRefused);
  EXPECT_NE(message.find("not a .tcb document"), std::string::npos);

  Bytes newer = small_document();
  newer[document::kMagic.size()] = std::byte{4};
  EXPECT_EQ(try_document(newer, &message), Outcome::kRefused);
  EXPECT_NE(message.find("format version 4"), std::string::npos);

  EXPECT_THROW(Reader::open(std::filesystem::temp_directory_path()), Error);
  EXPECT_THROW(Reader::open("/nonexistent/file.tcb"), Error);
}

TEST(Corruption, SkipsUnknownOptionalChunksAndRefusesOthers) {
  const Bytes good = small_document();
  const auto header_bytes = document::kChunkHeaderBytes;
  const auto first =
      document::kPreambleBytes + header_bytes +
      document::parse_chunk_header(std::span(good).subspan(document::kPreambleBytes, header_bytes), true)
          .length;
  const auto with_chunk = [&](std::uint32_t type) {
    // Cut off behind the first frame, so that offsets in an index do not matter.
    const auto frame = document::parse_chunk_header(std::span(good).subspan(first, header_bytes), true);
    Bytes bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(first));
    const Bytes extra = document::chunk(document::ChunkType{type}, std::vector<std::byte>(5));
    bytes.insert(bytes.end(), extra.begin(), extra.end());
    bytes.insert(bytes.end(), good.begin() + static_cast<std::ptrdiff_t>(first),
                 good.begin() + static_cast<std::ptrdiff_t>(first + header_bytes + frame.length));
    return bytes;
  };
  EXPECT_EQ(try_document(with_chunk(0x45544F6E)), Outcome::kRead);  // "nOTE"
  std::string message;
  EXPECT_EQ(try_document(with_chunk(0x45544F4E), &message), Outcome::kRefused);  // "NOTE"
  EXPECT_NE(message.find("unknown chunk NOTE"), std::string::npos);
}

}  // namespace
}  // namespace knotreel
