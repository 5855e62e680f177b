#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "document/streams.h"

/// One traversal for both directions: code(stream, value, prediction) either records value - prediction or
/// sets the value from the recorded difference, so that writer and reader cannot disagree about an order or a
/// prediction.
namespace knotreel::document {

/// Streams of differences, in the order of the file.
namespace stream {
inline constexpr std::size_t kBorder = 0;     ///< knots along the sides
inline constexpr std::size_t kVertex = 1;     ///< multiple knots inside, x and y in turn
inline constexpr std::size_t kParameter = 2;  ///< knots inside segments
inline constexpr std::size_t kFreeX = 3;
inline constexpr std::size_t kFreeY = 4;
inline constexpr std::size_t kDisplacementX = 5;
inline constexpr std::size_t kDisplacementY = 6;
inline constexpr std::size_t kColour = 7;  ///< one per channel
}  // namespace stream

class ResidualWriter {
 public:
  explicit ResidualWriter(std::size_t stream_count) : streams_(stream_count) {}

  void code(std::size_t stream, const std::int64_t& value, std::int64_t prediction) {
    streams_[stream].push_back(zigzag(value - prediction));
  }
  /// Writes all streams up to the last that holds anything but zeros.
  void write(StreamWriter& writer, ByteWriter& out) const {
    const auto is_zero = [](const auto& s) {
      return std::ranges::all_of(s, [](std::uint64_t v) { return v == 0; });
    };
    std::size_t count = streams_.size();
    while (count > 0 && is_zero(streams_[count - 1])) --count;
    for (std::size_t s = 0; s < count; ++s) writer.integers(out, streams_[s]);
  }

 private:
  std::vector<std::vector<std::uint64_t>> streams_;
};

class ResidualReader {
 public:
  explicit ResidualReader(std::size_t stream_count) : streams_(stream_count) {}

  /// Reads streams [first, last), each of at most max_count numbers.
  void read(std::size_t first, std::size_t last, std::size_t max_count, StreamReader& reader,
            ByteReader& in) {
    for (std::size_t s = first; s < last; ++s) streams_[s] = reader.integers(in, max_count);
  }
  // Values stay below 2^40 or are refused before they predict another, differences are below 2^60.
  void code(std::size_t stream, std::int64_t& value, std::int64_t prediction) {
    value = prediction + unzigzag(streams_[stream].next());
    if (value < -kBound || value > kBound) malformed("a number is out of range");
  }
  void require_used_up() const {
    for (const auto& s : streams_) {
      if (!s.used_up()) malformed("a stream is longer than the frame needs");
    }
  }

 private:
  static constexpr std::int64_t kBound = std::int64_t{1} << 40;
  std::vector<Symbols<std::uint64_t>> streams_;
};

}  // namespace knotreel::document
