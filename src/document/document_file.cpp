// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/document_file.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "document/crc32c.h"
#include "knotreel/base/error.h"

namespace knotreel::document {
namespace {

std::string type_name(ChunkType type) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<unsigned char>(static_cast<std::uint32_t>(type) >> (8 * i));
    name += std::isalpha(c) ? static_cast<char>(c) : '?';
  }
  return name;
}

}  // namespace

template <class Body>
auto DocumentFile::located(const std::uint64_t& offset, Body body) {
  const auto fail = [&](const char* what) {
    return Error(ErrorKind::kInput,
                 source_->name() + ": " + what + " (at byte " + std::to_string(offset) + ")");
  };
  try {
    return body();
  } catch (const Malformed& e) {
    throw fail(e.what());
  }
}

DocumentFile::DocumentFile(std::unique_ptr<ByteSource> source, bool verify_checksums)
    : source_(std::move(source)), verify_(verify_checksums) {
  open();
  if (!read_with_index()) scan();
  if (records_.empty()) {
    throw Error(ErrorKind::kInput,
                source_->name() + ": holds no whole frame (at byte " + std::to_string(first_chunk_) + ")");
  }
}

void DocumentFile::open() {
  std::uint64_t offset = 0;
  located(offset, [&] {
    const std::vector<std::byte> expected = preamble();
    const std::vector<std::byte> start =
        source_->read(0, static_cast<std::size_t>(std::min<std::uint64_t>(source_->size(), kPreambleBytes)));
    if (start.empty()) malformed("the file is empty");
    if (!std::equal(start.begin(),
                    start.begin() + static_cast<std::ptrdiff_t>(std::min(start.size(), kMagic.size())),
                    expected.begin())) {
      malformed("not a .tcb document");
    }
    if (start.size() < kPreambleBytes) malformed("the file ends early");
    offset = kMagic.size();
    const std::uint32_t version = ByteReader(std::span(start).subspan(kMagic.size())).u32();
    if (version != kVersion) {
      malformed("format version " + std::to_string(version) +
                " is not known to this program, which reads version " + std::to_string(kVersion));
    }
    offset = kPreambleBytes;
    const auto header = header_at(offset);
    if (!header) malformed("the file ends early");
    if (header->type != ChunkType::kHeader) malformed("the header chunk is missing");
    format_ = parse_header(payload_at(offset, *header));
    first_chunk_ = offset + kChunkHeaderBytes + header->length;
  });
}

std::optional<ChunkHeader> DocumentFile::header_at(std::uint64_t offset) {
  if (offset > source_->size() || source_->size() - offset < kChunkHeaderBytes) return std::nullopt;
  const ChunkHeader header = parse_chunk_header(source_->read(offset, kChunkHeaderBytes), verify_);
  if (source_->size() - offset - kChunkHeaderBytes < header.length) return std::nullopt;
  return header;
}

std::vector<std::byte> DocumentFile::payload_at(std::uint64_t offset, const ChunkHeader& header) {
  std::vector<std::byte> payload = source_->read(offset + kChunkHeaderBytes, header.length);
  if (verify_ && crc32c(payload) != header.payload_crc) {
    malformed("the " + type_name(header.type) + " chunk is damaged (checksum)");
  }
  return payload;
}

bool DocumentFile::read_with_index() {
  std::uint64_t offset = source_->size() - std::min<std::uint64_t>(source_->size(), kEndChunkBytes);
  if (offset < first_chunk_) return false;
  std::uint64_t index_offset = 0;
  try {
    const auto end = header_at(offset);
    if (!end || end->type != ChunkType::kEnd || end->length != kEndChunkBytes - kChunkHeaderBytes)
      return false;
    index_offset = ByteReader(payload_at(offset, *end)).u64();
  } catch (const Malformed&) {
    return false;  // the file ends with something else; scan() says with what
  }
  located(index_offset, [&] {
    if (index_offset < first_chunk_ || index_offset >= offset)
      malformed("the index is not where the end says");
    const auto header = header_at(index_offset);
    if (!header || header->type != ChunkType::kIndex) malformed("the index is not where the end says");
    if (index_offset + kChunkHeaderBytes + header->length != offset)
      malformed("the index has the wrong length");
    records_ = parse_index(payload_at(index_offset, *header));
    std::uint64_t behind = first_chunk_;
    for (const FrameRecord& r : records_) {
      if (r.offset < behind || r.bytes < kChunkHeaderBytes || r.offset > index_offset ||
          r.bytes > index_offset - r.offset) {
        malformed("the index places a frame where none can be");
      }
      behind = r.offset + r.bytes;
    }
    if (!records_.empty() && !records_.front().keyframe) malformed("the first frame is not a keyframe");
    read_behind_frames(behind, index_offset);
  });
  complete_ = true;
  return true;
}

void DocumentFile::read_behind_frames(std::uint64_t offset, std::uint64_t end) {
  while (offset < end) {
    const auto header = header_at(offset);
    if (!header) malformed("the file ends early");
    if (header->type == ChunkType::kLast) last_duration_ = parse_last(payload_at(offset, *header));
    offset += kChunkHeaderBytes + header->length;
  }
}

void DocumentFile::scan() {
  std::uint64_t offset = first_chunk_;
  located(offset, [&] {
    while (const auto header = header_at(offset)) {
      if (header->type == ChunkType::kFrame) {
        const FramePrefix prefix = read_prefix(payload_at(offset, *header));
        if (records_.empty() && !prefix.keyframe) malformed("the first frame is not a keyframe");
        if (!records_.empty()) require_later(prefix.pts, records_.back().pts);
        records_.push_back(
            {offset, kChunkHeaderBytes + header->length, prefix.frame, prefix.pts, prefix.keyframe});
      } else if (header->type == ChunkType::kEnd) {
        malformed("the end is damaged or not at the end of the file");
      } else if (header->type == ChunkType::kIndex) {
        // A document cut off within its end chunk: the index says nothing new.
      } else if (!is_optional(header->type)) {
        malformed("unknown chunk " + type_name(header->type) + "; a newer program may read it");
      }
      offset += kChunkHeaderBytes + header->length;
    }
  });
}

const FrameState& DocumentFile::read(std::size_t frame) {
  const bool ahead = state_ && state_frame_ <= frame;
  std::size_t from = ahead ? state_frame_ : 0;
  for (std::size_t k = from + (ahead ? 1 : 0); k <= frame; ++k) {
    if (records_[k].keyframe) from = k;
  }
  if (!ahead || from != state_frame_) decode(from);
  while (state_frame_ < frame) decode(state_frame_ + 1);
  return *state_;
}

void DocumentFile::decode(std::size_t frame) {
  const FrameRecord& record = records_[frame];
  const auto prefix_text = [&] { return "frame " + std::to_string(frame) + ": "; };
  located(record.offset, [&] {
    // A frame that fails leaves the one before in place.
    try {
      const auto header = header_at(record.offset);
      if (!header || header->type != ChunkType::kFrame ||
          kChunkHeaderBytes + header->length != record.bytes) {
        malformed("the index does not agree with the chunk");
      }
      const std::vector<std::byte> payload = payload_at(record.offset, *header);
      const FramePrefix prefix = read_prefix(payload);
      if (prefix.keyframe != record.keyframe || prefix.frame != record.frame || prefix.pts != record.pts) {
        malformed("the index does not agree with the frame");
      }
      const FrameState* before = record.keyframe ? nullptr : &*state_;
      FrameState state = decode_frame(payload, before, format_);
      state_ = std::move(state);
      state_frame_ = frame;
    } catch (const Malformed& e) {
      malformed(prefix_text() + e.what());
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInput) throw;
      malformed(prefix_text() + e.what());
    }
  });
}

}  // namespace knotreel::document
