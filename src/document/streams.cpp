#include "document/streams.h"

#include <zstd.h>

#include <algorithm>
#include <array>

#include "knotreel/base/error.h"

namespace knotreel::document {
namespace {

// The first four bytes of every zstd frame; left out of the document, since small streams are many.
constexpr std::array<std::byte, 4> kZstdMagic{std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F},
                                              std::byte{0xFD}};

// Values below kDirect are their own token. Above, a token holds the bit length and the two bits below the
// leading one; the rest follows as extra bits. So every byte is a token, and values reach up to 2^61 - 1.
constexpr std::uint8_t kDirect = 32;
constexpr int kDirectBits = 5;  // bit_width(kDirect) - 1

int extra_bits(std::uint8_t token) {
  return token < kDirect ? 0 : kDirectBits - 2 + (int{token} - int{kDirect}) / 4;
}

std::uint8_t token_of(std::uint64_t v) {
  if (v < kDirect) return static_cast<std::uint8_t>(v);
  const auto top = static_cast<int>(std::bit_width(v)) - 1;
  return static_cast<std::uint8_t>(kDirect + 4 * (top - kDirectBits) +
                                   static_cast<int>((v >> (top - 2)) & 3));
}

std::uint64_t base_of(std::uint8_t token) {
  if (token < kDirect) return token;
  return (4 + (std::uint64_t{token} - kDirect) % 4) << extra_bits(token);
}

/// Bits into bytes, lowest bit first.
class BitWriter {
 public:
  explicit BitWriter(ByteWriter& out) : out_(out) {}
  void put(std::uint64_t v, int bits) {
    for (int i = 0; i < bits; ++i) {
      buffer_ = static_cast<std::uint8_t>(buffer_ | (((v >> i) & 1) << used_));
      if (++used_ == 8) flush();
    }
  }
  void flush() {
    if (used_ > 0) out_.u8(buffer_);
    buffer_ = 0;
    used_ = 0;
  }

 private:
  ByteWriter& out_;
  std::uint8_t buffer_ = 0;
  int used_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t get(int bits) {
    std::uint64_t v = 0;
    for (int i = 0; i < bits; ++i, ++position_) {
      v |= ((std::to_integer<std::uint64_t>(bytes_[position_ / 8]) >> (position_ % 8)) & 1) << i;
    }
    return v;
  }

 private:
  std::span<const std::byte> bytes_;  // the caller has made sure that they suffice
  std::size_t position_ = 0;
};

}  // namespace

struct StreamWriter::Context {
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
  ~Context() { ZSTD_freeCCtx(zstd); }
};

StreamWriter::StreamWriter(int zstd_level) : context_(std::make_unique<Context>()) {
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_compressionLevel, zstd_level);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_contentSizeFlag, 0);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_checksumFlag, 0);
}

StreamWriter::~StreamWriter() = default;

void StreamWriter::bytes(ByteWriter& out, std::span<const std::uint8_t> symbols) {
  while (!symbols.empty() && symbols.back() == 0) symbols = symbols.first(symbols.size() - 1);
  out.varint(symbols.size());
  if (symbols.empty()) return;
  scratch_.resize(ZSTD_compressBound(symbols.size()));
  const std::size_t packed =
      ZSTD_compress2(context_->zstd, scratch_.data(), scratch_.size(), symbols.data(), symbols.size());
  if (ZSTD_isError(packed)) throw Error(ErrorKind::kInternal, ZSTD_getErrorName(packed));
  const std::size_t stored = packed - kZstdMagic.size();
  if (stored < symbols.size()) {
    out.varint(stored);
    out.bytes(std::span(scratch_).subspan(kZstdMagic.size(), stored));
  } else {
    out.varint(symbols.size());
    out.bytes(std::as_bytes(symbols));
  }
}

void StreamWriter::integers(ByteWriter& out, std::span<const std::uint64_t> values) {
  while (!values.empty() && values.back() == 0) values = values.first(values.size() - 1);
  std::vector<std::uint8_t> tokens(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) tokens[i] = token_of(values[i]);
  bytes(out, tokens);
  BitWriter bits(out);
  for (std::size_t i = 0; i < values.size(); ++i) bits.put(values[i], extra_bits(tokens[i]));
  bits.flush();
}

struct StreamReader::Context {
  ZSTD_DCtx* zstd = ZSTD_createDCtx();
  ~Context() { ZSTD_freeDCtx(zstd); }
};

StreamReader::StreamReader() : context_(std::make_unique<Context>()) {}
StreamReader::~StreamReader() = default;

std::vector<std::uint8_t> StreamReader::raw_bytes(ByteReader& in, std::size_t max_count) {
  if (in.remaining() == 0) return {};  // streams at the end of a payload may be missing: all zero
  const auto count = static_cast<std::size_t>(in.varint_in(0, max_count, "length of a stream"));
  if (count == 0) return {};
  const auto stored = in.take(static_cast<std::size_t>(in.varint_in(1, count, "stored size of a stream")));
  std::vector<std::uint8_t> symbols(count);
  if (stored.size() == count) {
    std::copy_n(reinterpret_cast<const std::uint8_t*>(stored.data()), count, symbols.begin());
    return symbols;
  }
  scratch_.assign(kZstdMagic.begin(), kZstdMagic.end());
  scratch_.insert(scratch_.end(), stored.begin(), stored.end());
  const std::size_t size =
      ZSTD_decompressDCtx(context_->zstd, symbols.data(), symbols.size(), scratch_.data(), scratch_.size());
  if (ZSTD_isError(size))
    malformed(std::string("a compressed stream is damaged: ") + ZSTD_getErrorName(size));
  if (size != count) malformed("a compressed stream has the wrong length");
  return symbols;
}

Symbols<std::uint8_t> StreamReader::bytes(ByteReader& in, std::size_t max_count) {
  return Symbols(raw_bytes(in, max_count));
}

Symbols<std::uint64_t> StreamReader::integers(ByteReader& in, std::size_t max_count) {
  const std::vector<std::uint8_t> tokens = raw_bytes(in, max_count);
  std::size_t bit_count = 0;
  for (const std::uint8_t token : tokens) bit_count += static_cast<std::size_t>(extra_bits(token));
  BitReader bits(in.take((bit_count + 7) / 8));
  std::vector<std::uint64_t> values(tokens.size());
  for (std::size_t i = 0; i < tokens.size(); ++i)
    values[i] = base_of(tokens[i]) + bits.get(extra_bits(tokens[i]));
  return Symbols(std::move(values));
}

}  // namespace knotreel::document
