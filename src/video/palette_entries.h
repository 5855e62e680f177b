// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "palette.h"

namespace knotreel::video {

/// The colours of a palette by channel, for vectors.
struct PaletteEntries {
  explicit PaletteEntries(const Palette& palette);

  std::array<float, 3> colour(std::size_t k) const { return {channel[0][k], channel[1][k], channel[2][k]}; }

  std::size_t first = 0;  ///< index of the first one
  std::size_t count = 0;
  std::array<std::array<float, 256>, 3> channel{};
};

/// An entry, counted from the first one, and what of it is least.
struct Least {
  std::size_t entry = 0;
  float value = 0;
};

/// The entry nearest to a colour, by the squared distance; the first of several.
Least nearest_entry(const PaletteEntries& entries, const std::array<float, 3>& colour);

/// The entry that makes the best mixtures with another one, by the squared distance of a colour from these,
/// and a share of the squared distance of the two, since patterns of much contrast are seen.
Least best_partner(const PaletteEntries& entries, std::size_t plain, const std::array<float, 3>& colour);

}  // namespace knotreel::video
