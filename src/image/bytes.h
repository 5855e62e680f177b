// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "codec.h"

namespace knotreel::image {

/// Bounds-checked integers at byte offsets.
class Bytes {
 public:
  explicit Bytes(std::span<const std::byte> file) : file_(file) {}

  std::uint32_t u8(std::size_t at) const {
    if (at >= file_.size()) throw DecodeError("the file is cut short");
    return std::to_integer<std::uint32_t>(file_[at]);
  }
  std::uint32_t le16(std::size_t at) const { return u8(at) | u8(at + 1) << 8; }
  std::uint32_t be16(std::size_t at) const { return u8(at) << 8 | u8(at + 1); }
  std::uint32_t le24(std::size_t at) const { return le16(at) | u8(at + 2) << 16; }
  std::uint32_t le32(std::size_t at) const { return le16(at) | le16(at + 2) << 16; }
  std::uint32_t be32(std::size_t at) const { return be16(at) << 16 | be16(at + 2); }
  std::size_t size() const { return file_.size(); }

 private:
  std::span<const std::byte> file_;
};

}  // namespace knotreel::image
