// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "document/bytes.h"
#include "document/frame_state.h"
#include "knotreel/document/reader.h"

/// Magic, version, chunks, header and index (docs/format.md, "Container").
namespace knotreel::document {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'T', 'C', 'B', 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::uint32_t kVersion = 3;
inline constexpr std::size_t kPreambleBytes = kMagic.size() + 4;

/// Four ASCII letters, the first in the lowest byte; a lower-case first letter marks a chunk that readers may
/// skip.
enum class ChunkType : std::uint32_t {
  kHeader = 0x44414548,  // "HEAD"
  kFrame = 0x4D415246,   // "FRAM"
  kLast = 0x7473616C,    // "last"
  kIndex = 0x58444E49,   // "INDX"
  kEnd = 0x454E4F44,     // "DONE"
};

inline bool is_optional(ChunkType type) {
  return (static_cast<std::uint32_t>(type) & 0x20u) != 0;
}

/// Type, length and CRC-32C of the payload, and the CRC-32C of these twelve bytes.
struct ChunkHeader {
  ChunkType type{};
  std::uint32_t length = 0;
  std::uint32_t payload_crc = 0;
};
inline constexpr std::size_t kChunkHeaderBytes = 16;

/// The last chunk: the offset of the index chunk, 8 bytes.
inline constexpr std::size_t kEndChunkBytes = kChunkHeaderBytes + 8;

std::vector<std::byte> preamble();

/// A whole chunk. @throws Error{kOutput} for a payload of 4 GiB and more.
std::vector<std::byte> chunk(ChunkType type, std::span<const std::byte> payload);

/// @param bytes  kChunkHeaderBytes of them. @throws Malformed if the checksum is wrong (unless not verified).
ChunkHeader parse_chunk_header(std::span<const std::byte> bytes, bool verify);

std::vector<std::byte> write_header(const Format& format);
Format parse_header(std::span<const std::byte> payload);

/// How long the last frame is shown.
std::vector<std::byte> write_last(std::int64_t duration);
std::int64_t parse_last(std::span<const std::byte> payload);

std::vector<std::byte> write_index(const std::vector<FrameRecord>& records);
std::vector<FrameRecord> parse_index(std::span<const std::byte> payload);

/// @throws Malformed if the time of a frame is not after that of the frame before.
void require_later(std::int64_t pts, std::int64_t before);

/// Checks what both Writer and Reader demand of an info. @return what is wrong, or null.
const char* find_defect(const SequenceInfo& info);

}  // namespace knotreel::document
