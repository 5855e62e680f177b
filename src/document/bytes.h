// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// Bytes and variable-length integers, the alphabet of docs/format.md.
namespace knotreel::document {

/// A document that breaks the rules of its format. Internal: the reader adds path and offset and throws
/// Error{kInput}.
class Malformed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void malformed(const std::string& what) {
  throw Malformed(what);
}

/// Signed integers as unsigned ones, small magnitudes first: 0, -1, 1, -2, 2 -> 0, 1, 2, 3, 4.
constexpr std::uint64_t zigzag(std::int64_t v) {
  return (static_cast<std::uint64_t>(v) << 1) ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t u) {
  return static_cast<std::int64_t>((u >> 1) ^ (~(u & 1) + 1));
}

/// Appends to a byte vector.
class ByteWriter {
 public:
  void u8(std::uint8_t v) { bytes_.push_back(static_cast<std::byte>(v)); }
  /// Little endian.
  void u32(std::uint32_t v) {
    for (int i = 0; i < 4; ++i) u8(static_cast<std::uint8_t>(v >> (8 * i)));
  }
  void u64(std::uint64_t v) {
    for (int i = 0; i < 8; ++i) u8(static_cast<std::uint8_t>(v >> (8 * i)));
  }
  /// LEB128: seven bits per byte, lowest first, high bit = more follows.
  void varint(std::uint64_t v) {
    for (; v >= 0x80; v >>= 7) u8(static_cast<std::uint8_t>(v | 0x80));
    u8(static_cast<std::uint8_t>(v));
  }
  void svarint(std::int64_t v) { varint(zigzag(v)); }
  void bytes(std::span<const std::byte> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }
  void text(std::string_view s) {
    varint(s.size());
    bytes(std::as_bytes(std::span(s)));
  }

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> view() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads from bytes that may be hostile: every access is checked, the end of the data is Malformed.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return std::to_integer<std::uint8_t>(take(1)[0]); }
  std::uint32_t u32() {
    std::uint32_t v = 0;
    for (int i = 0; i < 4; ++i) v |= std::uint32_t{u8()} << (8 * i);
    return v;
  }
  std::uint64_t u64() {
    std::uint64_t v = 0;
    for (int i = 0; i < 8; ++i) v |= std::uint64_t{u8()} << (8 * i);
    return v;
  }
  std::uint64_t varint() {
    std::uint64_t v = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t b = u8();
      if (shift == 63 && b > 1) break;
      v |= std::uint64_t{b & 0x7Fu} << shift;
      if (b < 0x80) return v;
    }
    malformed("a variable-length integer exceeds 64 bits");
  }
  std::int64_t svarint() { return unzigzag(varint()); }
  /// A varint in [low, high]; `name` goes into the message.
  std::uint64_t varint_in(std::uint64_t low, std::uint64_t high, const char* name) {
    const std::uint64_t v = varint();
    if (v < low || v > high) {
      malformed(std::string(name) + " is " + std::to_string(v) + ", outside " + std::to_string(low) + " to " +
                std::to_string(high));
    }
    return v;
  }
  std::span<const std::byte> take(std::size_t count) {
    if (count > remaining()) malformed("data ends early");
    const auto part = bytes_.subspan(position_, count);
    position_ += count;
    return part;
  }
  std::string text() {
    const auto part = take(varint_in(0, remaining(), "length of a text"));
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }

  std::size_t remaining() const { return bytes_.size() - position_; }
  std::size_t position() const { return position_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace knotreel::document
