// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace knotreel::image {

/// Which samples of a row of stored ones: every `step`-th from `first` on.
struct SamplesOfRow {
  std::size_t first = 0;
  std::size_t step = 1;
};

/// Writes `count` samples of a stored row as the numbers they are, to every `to_step`-th place.
using UnpackSamples = void (*)(const std::byte* row, SamplesOfRow from, std::size_t count, double* to,
                               std::size_t to_step);

/// How TIFF samples of so many bits are unpacked, as libtiff hands them out: whole bytes in the order of the
/// machine, others with the highest bit first.
/// @return null for what is not supported, such as 24 bits.
UnpackSamples tiff_unpacker(int bits, bool floats);

}  // namespace knotreel::image
