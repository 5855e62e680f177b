// SPDX-License-Identifier: GPL-3.0-or-later
#include "palette_entries.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/multiversion.h"

namespace knotreel::video {
namespace {

constexpr float kContrast = 0.2F;  ///< of the squared distance of two that are mixed in equal shares, times 4

/// Bits of values that are not negative: whole numbers in the same order, whose least vectors find.
using Values = std::array<std::int32_t, 256>;

KNOTREEL_MULTIVERSION
void find_distances(const PaletteEntries& entries, const std::array<float, 3>& colour,
                    std::int32_t* __restrict distances) {
  for (std::size_t k = 0; k < entries.count; ++k) {
    const float red = entries.channel[0][k] - colour[0], green = entries.channel[1][k] - colour[1],
                blue = entries.channel[2][k] - colour[2];
    distances[k] = std::bit_cast<std::int32_t>(red * red + green * green + blue * blue);
  }
}

KNOTREEL_MULTIVERSION
void find_costs(const PaletteEntries& entries, const std::array<float, 3>& plain,
                const std::array<float, 3>& colour, std::int32_t* __restrict costs) {
  constexpr float kAny = 1e-6F;  // for an entry's distance from itself
  const float red = colour[0] - plain[0], green = colour[1] - plain[1], blue = colour[2] - plain[2];
  for (std::size_t k = 0; k < entries.count; ++k) {
    const float to_red = entries.channel[0][k] - plain[0], to_green = entries.channel[1][k] - plain[1],
                to_blue = entries.channel[2][k] - plain[2];
    const float length = to_red * to_red + to_green * to_green + to_blue * to_blue;
    const float along = (red * to_red + green * to_green + blue * to_blue) / (length + kAny);
    const float low = along < 0 ? 0 : along;
    const float share = low > 1 ? 1 : low;
    const float off_red = red - share * to_red, off_green = green - share * to_green,
                off_blue = blue - share * to_blue;
    costs[k] = std::bit_cast<std::int32_t>(off_red * off_red + off_green * off_green + off_blue * off_blue +
                                           kContrast * share * (1 - share) * length);
  }
}

KNOTREEL_MULTIVERSION
std::int32_t least_value(const std::int32_t* values, std::size_t count) {
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (std::size_t k = 0; k < count; ++k) least = std::min(least, values[k]);
  return least;
}

Least least_of(const Values& values, std::size_t count) {
  const std::int32_t least = least_value(values.data(), count);
  const auto at = std::find(values.begin(), values.begin() + std::ptrdiff_t(count), least);
  return {std::size_t(at - values.begin()), std::bit_cast<float>(least)};
}

}  // namespace

PaletteEntries::PaletteEntries(const Palette& palette) : first(palette.first), count(palette.count) {
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t c = 0; c < 3; ++c)
      channel[c][k] = float(palette.colours[first + k] >> (16 - 8 * c) & 0xFF);
  }
}

Least nearest_entry(const PaletteEntries& entries, const std::array<float, 3>& colour) {
  Values values;
  find_distances(entries, colour, values.data());
  return least_of(values, entries.count);
}

Least best_partner(const PaletteEntries& entries, std::size_t plain, const std::array<float, 3>& colour) {
  Values values;
  find_costs(entries, entries.colour(plain), colour, values.data());
  return least_of(values, entries.count);
}

}  // namespace knotreel::video
