// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "knotreel/video/stream_info.h"

namespace knotreel::video {

/// A compressed packet of a stream that is copied: sound, subtitles. Copies share the bytes, which nobody
/// changes, so packets may go from thread to thread.
class Packet {
 public:
  Packet() = default;
  /// For the module's own use: `impl` is libav's packet with the numbers of its source.
  explicit Packet(std::shared_ptr<const void> impl) : impl_(std::move(impl)) {}

  /// Number of its stream in the source; -1 for an empty Packet.
  int stream() const;
  /// The bytes; they live as long as the Packet.
  std::span<const std::byte> bytes() const;
  /// When it is to be presented, in seconds; not a number if the source does not tell.
  double seconds() const;
  /// The same bytes, earlier by so many ticks.
  Packet earlier(std::int64_t ticks, Rational time_base) const;

  const void* impl() const { return impl_.get(); }

 private:
  std::shared_ptr<const void> impl_;
};

}  // namespace knotreel::video
