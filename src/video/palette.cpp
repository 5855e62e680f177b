// SPDX-License-Identifier: GPL-3.0-or-later
#include "palette.h"

#include <algorithm>
#include <array>
#include <vector>

#include "colour_cells.h"
#include "knotreel/base/parallel.h"
#include "palette_entries.h"

namespace knotreel::video {
namespace {

/// Times the squared error of colours that are chosen anew, up to which those of the frame before stay.
constexpr double kStay = 1.25;
constexpr int kPasses = 3;  ///< of settling

/// Pixels of a cell.
struct Cell {
  double count = 0;
  std::array<double, 3> sum{};
  double mean(std::size_t c) const { return sum[c] / count; }
  void add(const Cell& other) {
    count += other.count;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += other.sum[c];
  }
};

/// Cells [begin, end) that share a colour.
struct Group {
  std::size_t begin = 0, end = 0;
  Cell sum;
  double error = 0;        ///< squares, over pixels and channels
  std::size_t widest = 0;  ///< channel
};

Group group_of(const std::vector<Cell>& cells, std::size_t begin, std::size_t end) {
  Group group{begin, end, {}, 0, 0};
  for (std::size_t i = begin; i < end; ++i) group.sum.add(cells[i]);
  std::array<double, 3> squares{};
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = cells[i].mean(c) - group.sum.mean(c);
      squares[c] += cells[i].count * d * d;
    }
  }
  group.widest = std::size_t(std::max_element(squares.begin(), squares.end()) - squares.begin());
  group.error = squares[0] + squares[1] + squares[2];
  return group;
}

/// At most so many groups.
std::vector<Group> groups_of(std::vector<Cell>& cells, std::size_t most) {
  constexpr double kNothing = 1e-6;
  std::vector<Group> groups;
  if (!cells.empty()) groups.push_back(group_of(cells, 0, cells.size()));
  while (!groups.empty() && groups.size() < most) {
    const auto worst = std::max_element(groups.begin(), groups.end(),
                                        [](const Group& a, const Group& b) { return a.error < b.error; });
    if (worst->error < kNothing) break;
    const Group whole = *worst;
    const auto first = cells.begin() + std::ptrdiff_t(whole.begin);
    const auto last = cells.begin() + std::ptrdiff_t(whole.end);
    const auto half = std::stable_partition(
        first, last, [&](const Cell& c) { return c.mean(whole.widest) < whole.sum.mean(whole.widest); });
    const auto middle = std::size_t(half - cells.begin());
    *worst = group_of(cells, whole.begin, middle);
    groups.push_back(group_of(cells, middle, whole.end));
  }
  return groups;
}

/// All colours that are seen, in order; more than a palette has: none.
std::vector<std::uint32_t> few_colours(const ColourPixels& pixels) {
  const std::size_t most = pixels.has_alpha() ? 255 : 256;
  std::vector<bool> known(std::size_t{1} << 24);
  std::vector<std::uint32_t> colours;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels.is_seen(i)) continue;
    const std::uint32_t colour = packed(pixels.colour(i));
    if (known[colour]) continue;
    known[colour] = true;
    colours.push_back(colour);
    if (colours.size() > most) return {};
  }
  std::sort(colours.begin(), colours.end());
  return colours;
}

bool holds_all(const Palette& palette, const std::vector<std::uint32_t>& colours) {
  std::vector<std::uint32_t> there(palette.colours.begin(), palette.colours.end());
  std::sort(there.begin(), there.end());
  return std::all_of(colours.begin(), colours.end(), [&](std::uint32_t colour) {
    return std::binary_search(there.begin(), there.end(), 0xFF000000 | colour);
  });
}

Palette palette_of(const std::vector<std::uint32_t>& colours) {
  Palette palette;
  palette.first = colours.size() < palette.colours.size() ? 1 : 0;
  palette.count = colours.size();
  for (std::size_t k = 0; k < colours.size(); ++k)
    palette.colours[palette.first + k] = 0xFF000000 | colours[k];
  return palette;
}

std::vector<Cell> cells_of(const ColourPixels& pixels) {
  std::vector<Cell> all(kColourCells);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels.is_seen(i)) continue;
    const Colour colour = pixels.colour(i);
    Cell& cell = all[cell_of(colour)];
    cell.count += 1;
    for (std::size_t c = 0; c < 3; ++c) cell.sum[c] += colour[c];
  }
  std::erase_if(all, [](const Cell& cell) { return cell.count == 0; });
  return all;
}

std::uint32_t packed_mean(const Cell& cell) {
  std::uint32_t colour = 0;
  for (std::size_t c = 0; c < 3; ++c) colour = colour << 8 | std::uint32_t(cell.mean(c) + 0.5);
  return colour;
}

std::array<float, 3> mean_of(const Cell& cell) {
  return {float(cell.mean(0)), float(cell.mean(1)), float(cell.mean(2))};
}

/// For each cell the entry that is nearest. In parallel.
std::vector<Least> nearest_entries(const Palette& palette, const std::vector<Cell>& cells) {
  const PaletteEntries entries(palette);
  std::vector<Least> nearest(cells.size());
  parallel_for(cells.size(), [&](std::size_t i) { nearest[i] = nearest_entry(entries, mean_of(cells[i])); });
  return nearest;
}

/// The squares that the nearest colours miss, over pixels and channels.
double error_of(const Palette& palette, const std::vector<Cell>& cells) {
  const std::vector<Least> nearest = nearest_entries(palette, cells);
  double error = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) error += cells[i].count * double(nearest[i].value);
  return error;
}

/// Every colour becomes the mean of the cells that it is nearest to (after [Lloyd82]).
void settle(Palette& palette, const std::vector<Cell>& cells) {
  const std::vector<Least> nearest = nearest_entries(palette, cells);
  std::vector<Cell> sums(palette.count);
  for (std::size_t i = 0; i < cells.size(); ++i) sums[nearest[i].entry].add(cells[i]);
  for (std::size_t k = 0; k < palette.count; ++k) {
    if (sums[k].count > 0) palette.colours[palette.first + k] = 0xFF000000 | packed_mean(sums[k]);
  }
}

}  // namespace

Palette choose_palette(const image::Image& picture, const Palette* before) {
  const ColourPixels pixels(picture);
  if (const auto few = few_colours(pixels); !few.empty()) {
    return before != nullptr && holds_all(*before, few) ? *before : palette_of(few);
  }
  std::vector<Cell> cells = cells_of(pixels);
  const std::vector<Group> groups = groups_of(cells, 255);
  double error = 0;
  std::vector<std::uint32_t> colours;
  for (const Group& group : groups) {
    error += group.error;
    colours.push_back(packed_mean(group.sum));
  }
  if (before != nullptr && before->count > 0 && error_of(*before, cells) <= kStay * error) return *before;
  Palette palette = palette_of(colours);
  for (int pass = 0; pass < kPasses; ++pass) settle(palette, cells);
  return palette;
}

}  // namespace knotreel::video
