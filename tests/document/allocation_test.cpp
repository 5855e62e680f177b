// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include "document/bytes.h"
#include "document/container.h"
#include "document/frame_codec.h"
#include "document/reseal.h"
#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"

// Every allocation of this program is counted.
namespace {

std::atomic<std::size_t> live{0};
std::atomic<std::size_t> peak{0};

void* counted(std::size_t size) {
  void* p = std::malloc(size > 0 ? size : 1);
  if (!p) throw std::bad_alloc();
  const std::size_t now = live += malloc_usable_size(p);
  std::size_t high = peak;
  while (now > high && !peak.compare_exchange_weak(high, now)) {
  }
  return p;
}

void release(void* p) noexcept {
  if (!p) return;
  live -= malloc_usable_size(p);
  std::free(p);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* p) noexcept {
  release(p);
}
void operator delete[](void* p) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t) noexcept {
  release(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  release(p);
}

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;
using Bytes = std::vector<std::byte>;

constexpr std::uint64_t kAllocationSeed = 99;

/// Peak of the memory taken while opening and reading, beyond what was there before.
std::size_t peak_of(const Bytes& bytes) {
  const std::size_t before = live;
  peak = before;
  try {
    Reader reader = Reader::open(bytes);
    for (std::size_t f = 0; f < reader.frame_count(); ++f) reader.read(f);
  } catch (const Error&) {
  }
  return peak - before;
}

/// docs/format.md, "Bounds".
std::size_t bound(std::size_t file_bytes) {
  return (1u << 20) + 1024 * file_bytes;
}

TEST(Allocation, StaysBelowTheBoundForTheDensestDocuments) {
  // One colour everywhere and no displacement: nothing but connectivity, the most memory per byte.
  for (int degree = 1; degree <= 3; ++degree) {
    FrameModel model = testing::random_model(testing::random_mesh(2000, 1500, 10000, 0, kAllocationSeed),
                                             degree, 4, kAllocationSeed);
    for (Vec2& d : model.displacement) d = {};
    for (double& c : model.colour) c = 0;
    const Bytes bytes = testing::write_document({model});
    const std::size_t used = peak_of(bytes);
    RecordProperty("bytes_per_file_byte_degree_" + std::to_string(degree),
                   static_cast<int>(used / bytes.size()));
    EXPECT_LT(used, bound(bytes.size())) << "degree " << degree << ", file " << bytes.size();
    EXPECT_GT(used, bytes.size()) << "the counter works";
  }
}

TEST(Allocation, StaysBelowTheBoundForDamagedDocuments) {
  std::vector<FrameModel> frames{
      testing::random_model(testing::random_mesh(160, 120, 100, 2, kAllocationSeed), 2, 3, kAllocationSeed)};
  frames.push_back(testing::successor(frames.back(), 3, kAllocationSeed));
  const Bytes good = testing::write_document(frames);
  std::mt19937_64 random(kAllocationSeed);
  for (int i = 0; i < 3000; ++i) {
    Bytes bad = good;
    for (std::uint64_t flips = 1 + random() % 3; flips > 0; --flips) {
      bad[random() % bad.size()] ^= static_cast<std::byte>(1 << random() % 8);
    }
    testing::reseal(bad);
    ASSERT_LT(peak_of(bad), bound(bad.size())) << "case " << i;
  }
}

TEST(Allocation, HugeClaimsCostNothing) {
  // A frame of a few bytes that claims as many knots, segments, link codes and stream symbols as fit in 64
  // bits.
  const Bytes whole = testing::write_document(
      {testing::random_model(testing::random_mesh(64, 48, 12, 0, kAllocationSeed), 2, 3, kAllocationSeed)});
  for (const std::uint64_t claim : {1ull << 20, 1ull << 31, 1ull << 32, 1ull << 40, ~0ull}) {
    for (std::size_t place = 0; place < 12; ++place) {
      document::ByteWriter frame;
      frame.u8(3);
      frame.varint(0);
      frame.svarint(0);
      frame.u8(6);
      for (std::size_t field = 0; field < 12; ++field)
        frame.varint(field == place ? claim : field == 4 ? 1 : 0);
      const Bytes chunk = document::chunk(document::ChunkType::kFrame, frame.view());
      const auto header = document::parse_chunk_header(
          std::span(whole).subspan(document::kPreambleBytes, document::kChunkHeaderBytes), true);
      Bytes bytes(whole.begin(),
                  whole.begin() + static_cast<std::ptrdiff_t>(document::kPreambleBytes +
                                                              document::kChunkHeaderBytes + header.length));
      bytes.insert(bytes.end(), chunk.begin(), chunk.end());
      ASSERT_LT(peak_of(bytes), 1u << 20) << "claim " << claim << " in field " << place;
    }
  }
  // The same for the length of a chunk.
  Bytes bytes = whole;
  bytes[document::kPreambleBytes + 7] = std::byte{0x7f};
  testing::reseal(bytes);
  ASSERT_LT(peak_of(bytes), 1u << 20);
}

}  // namespace
}  // namespace knotreel
