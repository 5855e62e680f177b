// SPDX-License-Identifier: GPL-3.0-or-later
#include "dither.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "colour_cells.h"
#include "knotreel/base/parallel.h"
#include "palette_entries.h"

namespace knotreel::video {
namespace {

constexpr std::size_t kSide = 8;  ///< pixels of the pattern
/// How far around equal shares colours are mixed, of all of the way: the rest of a pattern would be single
/// pixels of another colour, for a fifth more bytes.
constexpr float kMixed = 0.5F;
/// Share of a mixture that a pixel's own may be off before it changes.
constexpr float kHeldThreshold = 0.12F;

/// Shares of a mixture from which on a pixel of the pattern has its second colour.
constexpr std::array<float, kSide* kSide> kThresholds = [] {
  std::array<float, kSide * kSide> thresholds{};
  for (std::size_t y = 0; y < kSide; ++y) {
    for (std::size_t x = 0; x < kSide; ++x) {
      std::size_t rank = 0;  // bits of x ^ y and y, the lowest first
      for (std::size_t bit = 0; bit < 3; ++bit)
        rank = rank * 4 + 2 * (((x ^ y) >> bit) & 1) + ((y >> bit) & 1);
      const float place = (float(rank) + 0.5F) / float(kSide * kSide);
      thresholds[y * kSide + x] = 0.5F + kMixed * (place - 0.5F);
    }
  }
  return thresholds;
}();

/// Two entries of a palette, and how a colour is between them.
struct Mixture {
  std::uint8_t plain = 0, other = 0;
  std::array<float, 3> from{};   ///< the plain one
  std::array<float, 3> along{};  ///< to the other, over its squared length

  /// 0: all of the plain one; 1: all of the other.
  float share(const float* colour) const {
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += (colour[c] - from[c]) * along[c];
    return sum;
  }
};

Mixture best_mixture(const PaletteEntries& entries, const std::array<float, 3>& colour) {
  const std::size_t plain = nearest_entry(entries, colour).entry;
  const std::size_t other = best_partner(entries, plain, colour).entry;
  Mixture mixture;
  mixture.plain = std::uint8_t(entries.first + plain);
  mixture.other = std::uint8_t(entries.first + other);
  mixture.from = entries.colour(plain);
  mixture.along = entries.colour(other);
  float length = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    mixture.along[c] -= mixture.from[c];
    length += mixture.along[c] * mixture.along[c];
  }
  for (float& a : mixture.along) a = length > 0 ? a / length : 0;
  return mixture;
}

/// Of the cells that a picture has. The same for the same cell in every picture.
class Mixtures {
 public:
  Mixtures(const ColourPixels& pixels, const Palette& palette) : place_of_(kColourCells, kNowhere) {
    std::vector<std::size_t> cells;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!pixels.is_seen(i)) continue;
      const std::size_t cell = cell_of(pixels.colour(i));
      if (place_of_[cell] != kNowhere) continue;
      place_of_[cell] = std::uint32_t(cells.size());
      cells.push_back(cell);
    }
    const PaletteEntries entries(palette);
    mixtures_.resize(cells.size());
    parallel_for(cells.size(),
                 [&](std::size_t i) { mixtures_[i] = best_mixture(entries, centre_of_cell(cells[i])); });
  }

  const Mixture& of(std::size_t cell) const { return mixtures_[place_of_[cell]]; }

 private:
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

  std::vector<std::uint32_t> place_of_;  ///< by cell
  std::vector<Mixture> mixtures_;
};

/// A colour and its index.
using Entry = std::pair<std::uint32_t, std::size_t>;
constexpr std::size_t kNone = 256;

std::vector<Entry> sorted_entries(const Palette& palette) {
  std::vector<Entry> entries;
  for (std::size_t k = palette.first; k < palette.first + palette.count; ++k)
    entries.emplace_back(palette.colours[k] & 0xFFFFFF, k);
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::size_t exact_entry(const std::vector<Entry>& sorted, const Colour& colour) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), Entry(packed(colour), 0));
  return at != sorted.end() && at->first == packed(colour) ? at->second : kNone;
}

}  // namespace

std::vector<std::uint8_t> dithered(const image::Image& picture, const Palette& palette,
                                   std::span<const std::uint8_t> before) {
  const ColourPixels pixels(picture);
  const Mixtures mixtures(pixels, palette);
  const std::vector<Entry> sorted = sorted_entries(palette);
  std::vector<std::uint8_t> indices(pixels.size());
  const auto width = std::size_t(picture.width);
  parallel_for(std::size_t(picture.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (!pixels.is_seen(i)) continue;
      const Colour rounded = pixels.colour(i);
      const std::size_t exact = exact_entry(sorted, rounded);
      if (exact < kNone) {
        indices[i] = std::uint8_t(exact);
        continue;
      }
      const Mixture& mixture = mixtures.of(cell_of(rounded));
      float threshold = kThresholds[y % kSide * kSide + x % kSide];
      if (!before.empty() && before[i] == mixture.plain) threshold += kHeldThreshold;
      if (!before.empty() && before[i] == mixture.other) threshold -= kHeldThreshold;
      indices[i] = mixture.share(pixels.exact_colour(i).data()) > threshold ? mixture.other : mixture.plain;
    }
  });
  return indices;
}

}  // namespace knotreel::video
