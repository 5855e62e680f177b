// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/reseal.h"

#include <algorithm>
#include <span>

#include "document/container.h"
#include "document/crc32c.h"

namespace knotreel::testing {

void reseal(std::vector<std::byte>& document) {
  using document::kChunkHeaderBytes;
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) document[at + i] = static_cast<std::byte>(value >> (8 * i));
  };
  std::size_t at = document::kPreambleBytes;
  while (at + kChunkHeaderBytes <= document.size()) {
    const auto bytes = std::span(document).subspan(at);
    const auto header = document::parse_chunk_header(bytes.first(kChunkHeaderBytes), false);
    const std::size_t length = std::min<std::size_t>(header.length, bytes.size() - kChunkHeaderBytes);
    put(at + 8, document::crc32c(bytes.subspan(kChunkHeaderBytes, length)));
    put(at + 12, document::crc32c(bytes.first(12)));
    at += kChunkHeaderBytes + length;
  }
}

}  // namespace knotreel::testing
