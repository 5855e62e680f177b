// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "knotreel/image/format.h"

namespace knotreel::image {

struct ProbedSize {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

/// Reads the size that the header of a JPEG, WebP or BMP announces, so that a decoder is only started
/// on pictures of acceptable size. For JPEG it also makes sure that the end marker is there, since the
/// decoder fills up missing data silently.
/// @throws DecodeError if the header is damaged or cut short.
ProbedSize probe_size(std::span<const std::byte> file, ImageFormat format);

}  // namespace knotreel::image
