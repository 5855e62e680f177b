// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace knotreel::document {

/// CRC-32C (Castagnoli: reflected polynomial 0x82F63B78, initial value and final xor 0xFFFFFFFF).
/// Finds every single bit flip and every burst of up to 32 bits.
std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace knotreel::document
