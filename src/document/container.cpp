// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/container.h"

#include <limits>
#include <string>

#include "document/crc32c.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"

namespace knotreel::document {
namespace {

constexpr int kMaxSize = 1'000'000;

void put_chunk_header(ByteWriter& out, ChunkType type, std::span<const std::byte> payload) {
  ByteWriter fields;
  fields.u32(static_cast<std::uint32_t>(type));
  fields.u32(static_cast<std::uint32_t>(payload.size()));
  fields.u32(crc32c(payload));
  out.bytes(fields.view());
  out.u32(crc32c(fields.view()));
}

}  // namespace

std::vector<std::byte> preamble() {
  ByteWriter out;
  for (const std::uint8_t b : kMagic) out.u8(b);
  out.u32(kVersion);
  return out.take();
}

std::vector<std::byte> chunk(ChunkType type, std::span<const std::byte> payload) {
  if (payload.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorKind::kOutput, "a chunk of the document exceeds 4 GiB");
  }
  ByteWriter out;
  put_chunk_header(out, type, payload);
  out.bytes(payload);
  return out.take();
}

ChunkHeader parse_chunk_header(std::span<const std::byte> bytes, bool verify) {
  ByteReader in(bytes);
  ChunkHeader header;
  header.type = ChunkType{in.u32()};
  header.length = in.u32();
  header.payload_crc = in.u32();
  if (in.u32() != crc32c(bytes.first(kChunkHeaderBytes - 4)) && verify) {
    malformed("a chunk header is damaged (checksum)");
  }
  return header;
}

const char* find_defect(const SequenceInfo& info) {
  if (info.width < 1 || info.width > kMaxSize || info.height < 1 || info.height > kMaxSize) {
    return "the size of a document is 1 to 1000000 pixels either way";
  }
  if (info.channels < 1 || info.channels > 4) return "a document has 1 to 4 channels";
  if (info.degree < 1 || info.degree > spline::kMaxDegree) return "the degree of a document is 1 to 3";
  constexpr std::int64_t kMaxTime = std::numeric_limits<std::int32_t>::max();
  if (info.time_base_num < 1 || info.time_base_num > kMaxTime || info.time_base_den < 1 ||
      info.time_base_den > kMaxTime) {
    return "the time base of a document is a fraction of numbers from 1 to 2147483647";
  }
  return nullptr;
}

std::vector<std::byte> write_header(const Format& format) {
  ByteWriter out;
  out.varint(static_cast<std::uint64_t>(format.info.width));
  out.varint(static_cast<std::uint64_t>(format.info.height));
  out.varint(static_cast<std::uint64_t>(format.info.channels));
  out.varint(static_cast<std::uint64_t>(format.info.degree));
  out.varint(static_cast<std::uint64_t>(format.info.time_base_num));
  out.varint(static_cast<std::uint64_t>(format.info.time_base_den));
  out.varint(format.colour_step);
  out.varint(format.displacement_step);
  out.varint(format.info.metadata.size());
  for (const auto& [name, value] : format.info.metadata) {
    out.text(name);
    out.text(value);
  }
  return out.take();
}

Format parse_header(std::span<const std::byte> payload) {
  ByteReader in(payload);
  constexpr std::uint64_t kInt = std::numeric_limits<std::int32_t>::max();
  Format format;
  format.info.width = static_cast<int>(in.varint_in(0, kInt, "the width"));
  format.info.height = static_cast<int>(in.varint_in(0, kInt, "the height"));
  format.info.channels = static_cast<int>(in.varint_in(0, kInt, "the number of channels"));
  format.info.degree = static_cast<int>(in.varint_in(0, kInt, "the degree"));
  format.info.time_base_num = static_cast<std::int64_t>(in.varint_in(0, kInt, "the time base"));
  format.info.time_base_den = static_cast<std::int64_t>(in.varint_in(0, kInt, "the time base"));
  if (const char* defect = find_defect(format.info)) malformed(defect);
  format.colour_step = static_cast<std::uint32_t>(in.varint_in(1, 65535, "the colour step"));
  format.displacement_step = static_cast<std::uint32_t>(in.varint_in(1, 65535, "the displacement step"));
  for (std::uint64_t left = in.varint_in(0, in.remaining(), "the number of metadata"); left > 0; --left) {
    std::string name = in.text();
    std::string value = in.text();
    auto& metadata = format.info.metadata;
    if (!metadata.empty() && name <= metadata.rbegin()->first)
      malformed("the names of metadata are not distinct and ascending");
    metadata.emplace_hint(metadata.end(), std::move(name), std::move(value));
  }
  if (in.remaining() > 0) malformed("data after the header");
  return format;
}

std::vector<std::byte> write_last(std::int64_t duration) {
  ByteWriter out;
  out.varint(static_cast<std::uint64_t>(duration));
  return out.take();
}

std::int64_t parse_last(std::span<const std::byte> payload) {
  ByteReader in(payload);
  const auto most = static_cast<std::uint64_t>(kMaxTicks);
  const auto duration = static_cast<std::int64_t>(in.varint_in(1, most, "the duration of the last frame"));
  if (in.remaining() > 0) malformed("data after the duration of the last frame");
  return duration;
}

std::vector<std::byte> write_index(const std::vector<FrameRecord>& records) {
  ByteWriter out;
  out.varint(records.size());
  FrameRecord last;
  for (const FrameRecord& r : records) {
    out.varint(r.offset - last.offset);
    out.varint(2 * r.bytes + (r.keyframe ? 1 : 0));
    out.svarint(static_cast<std::int64_t>(r.frame - last.frame));
    out.svarint(
        static_cast<std::int64_t>(static_cast<std::uint64_t>(r.pts) - static_cast<std::uint64_t>(last.pts)));
    last = r;
  }
  return out.take();
}

void require_later(std::int64_t pts, std::int64_t before) {
  if (pts <= before) malformed("the time of a frame is not after that of the frame before");
}

std::vector<FrameRecord> parse_index(std::span<const std::byte> payload) {
  ByteReader in(payload);
  // A record has four bytes at least.
  std::vector<FrameRecord> records(in.varint_in(0, in.remaining() / 4, "the number of frames"));
  FrameRecord last;
  for (FrameRecord& r : records) {
    r.offset = last.offset + in.varint();
    const std::uint64_t size = in.varint();
    r.bytes = size / 2;
    r.keyframe = size % 2 != 0;
    r.frame = last.frame + static_cast<std::uint64_t>(in.svarint());
    r.pts = static_cast<std::int64_t>(static_cast<std::uint64_t>(last.pts) +
                                      static_cast<std::uint64_t>(in.svarint()));
    if (!is_time(r.pts)) malformed("the time of a frame is out of range");
    if (&r != &records.front()) require_later(r.pts, last.pts);
    last = r;
  }
  if (in.remaining() > 0) malformed("data after the index");
  return records;
}

}  // namespace knotreel::document
