#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "document/bytes.h"

/// Entropy-coded sequences of small numbers (docs/format.md, "Streams"). A stream is endless: what lies
/// behind its last stored symbol is zero, so trailing zeros cost nothing.
namespace knotreel::document {

/// Writes streams into a payload; keeps a zstd context, so one object serves a whole sequence.
class StreamWriter {
 public:
  explicit StreamWriter(int zstd_level);
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// A byte stream.
  void bytes(ByteWriter& out, std::span<const std::uint8_t> symbols);
  /// An integer stream: tokens as a byte stream, then the extra bits.
  void integers(ByteWriter& out, std::span<const std::uint64_t> values);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::vector<std::byte> scratch_;
};

/// The symbols of one decoded stream.
template <class T>
class Symbols {
 public:
  Symbols() = default;
  explicit Symbols(std::vector<T> values) : values_(std::move(values)) {}

  T next() { return cursor_ < values_.size() ? values_[cursor_++] : T{0}; }
  /// True when every stored symbol was taken: what the reader demands in the end.
  bool used_up() const { return cursor_ == values_.size(); }

 private:
  std::vector<T> values_;
  std::size_t cursor_ = 0;
};

/// Reads streams from a hostile payload. `max_count` is what the caller can use at most; a longer stream is
/// Malformed before anything of that size is allocated.
class StreamReader {
 public:
  StreamReader();
  ~StreamReader();
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  Symbols<std::uint8_t> bytes(ByteReader& in, std::size_t max_count);
  Symbols<std::uint64_t> integers(ByteReader& in, std::size_t max_count);

 private:
  std::vector<std::uint8_t> raw_bytes(ByteReader& in, std::size_t max_count);

  struct Context;
  std::unique_ptr<Context> context_;
  std::vector<std::byte> scratch_;
};

}  // namespace knotreel::document
