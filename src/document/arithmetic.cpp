// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/arithmetic.h"

#include <algorithm>

#include "document/bytes.h"

namespace knotreel::document {
namespace {

constexpr std::uint32_t kTopByte = 0xff000000;

}  // namespace

void ArithmeticWriter::narrow(std::uint32_t middle, bool value) {
  if (value) {
    high_ = middle;
  } else {
    low_ = middle + 1;
  }
  while (((low_ ^ high_) & kTopByte) == 0) {
    bytes_.push_back(static_cast<std::byte>(low_ >> 24));
    low_ <<= 8;
    high_ = (high_ << 8) | 0xff;
  }
}

std::uint64_t ArithmeticWriter::even_bits(std::uint64_t value, int count) {
  for (int i = count; i-- > 0;) narrow(cut(low_, high_, 32768), (value >> i) & 1);
  return value;
}

std::vector<std::byte> ArithmeticWriter::finish() {
  // Some number in [low, high] with as many zero bytes at its end as possible.
  for (int kept = 0; kept <= 4; ++kept) {
    const std::uint64_t rest = (std::uint64_t{1} << (32 - 8 * kept)) - 1;
    const std::uint64_t number = (low_ + rest) & ~rest;
    if (number > high_) continue;
    for (int i = 0; i < kept; ++i) bytes_.push_back(static_cast<std::byte>(number >> (24 - 8 * i)));
    break;
  }
  while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
  return std::move(bytes_);
}

ArithmeticReader::ArithmeticReader(std::span<const std::byte> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) code_ = (code_ << 8) | next_byte();
}

std::uint8_t ArithmeticReader::next_byte() {
  if (position_ == bytes_.size()) return 0;
  return std::to_integer<std::uint8_t>(bytes_[position_++]);
}

bool ArithmeticReader::narrow(std::uint32_t middle) {
  const bool value = code_ <= middle;
  if (value) {
    high_ = middle;
  } else {
    low_ = middle + 1;
  }
  while (((low_ ^ high_) & kTopByte) == 0) {
    low_ <<= 8;
    high_ = (high_ << 8) | 0xff;
    code_ = (code_ << 8) | next_byte();
  }
  return value;
}

std::uint64_t ArithmeticReader::even_bits(std::uint64_t, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 1) | (narrow(cut(low_, high_, 32768)) ? 1 : 0);
  return value;
}

void ArithmeticReader::require_end() const {
  const auto rest = bytes_.subspan(position_);
  if (!std::ranges::all_of(rest, [](std::byte b) { return b == std::byte{0}; })) {
    malformed("data after the end of a frame");
  }
}

}  // namespace knotreel::document
