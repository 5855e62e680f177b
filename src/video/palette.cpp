#include "palette.h"

#include <algorithm>

namespace knotreel::video {
namespace {

constexpr int kBits = 6;  // of each channel of a cell
constexpr std::size_t kCells = std::size_t{1} << (3 * kBits);

using Colour = std::array<std::uint8_t, 3>;

std::size_t cell_of(const Colour& c) {
  constexpr int kDown = 8 - kBits;
  return (std::size_t(c[0] >> kDown) << (2 * kBits)) | (std::size_t(c[1] >> kDown) << kBits) |
         std::size_t(c[2] >> kDown);
}

/// Pixels of a cell.
struct Cell {
  std::uint32_t index = 0;
  double count = 0;
  std::array<double, 3> sum{};
  double mean(std::size_t c) const { return sum[c] / count; }
};

/// Cells [begin, end) that share a colour.
struct Group {
  std::size_t begin = 0, end = 0;
  std::array<double, 3> mean{};
  double error = 0;        ///< squares, over pixels and channels
  std::size_t widest = 0;  ///< channel
};

Group group_of(const std::vector<Cell>& cells, std::size_t begin, std::size_t end) {
  Group group{begin, end, {}, 0, 0};
  double count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    count += cells[i].count;
    for (std::size_t c = 0; c < 3; ++c) group.mean[c] += cells[i].sum[c];
  }
  for (double& m : group.mean) m /= count;
  std::array<double, 3> squares{};
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = cells[i].mean(c) - group.mean[c];
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
        first, last, [&](const Cell& c) { return c.mean(whole.widest) < whole.mean[whole.widest]; });
    const auto middle = std::size_t(half - cells.begin());
    *worst = group_of(cells, whole.begin, middle);
    groups.push_back(group_of(cells, middle, whole.end));
  }
  return groups;
}

Colour colour_of(const image::Image& picture, const float* pixel) {
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c) {
    const float sample = pixel[picture.colour_channels() == 1 ? 0 : c];
    colour[c] = std::uint8_t(std::clamp(sample, 0.0F, 255.0F) + 0.5F);
  }
  return colour;
}

/// The pixels of a picture, rounded.
class Pixels {
 public:
  explicit Pixels(const image::Image& picture) : picture_(picture) {}

  std::size_t size() const { return picture_.pixel_count(); }
  bool is_seen(std::size_t i) const {
    return !picture_.has_alpha() || at(i)[picture_.channels - 1] >= 127.5F;
  }
  Colour colour(std::size_t i) const { return colour_of(picture_, at(i)); }
  /// Entries of a palette that are left for colours, and the first of them.
  std::size_t most() const { return 256 - first(); }
  std::size_t first() const { return picture_.has_alpha() ? 1 : 0; }

 private:
  const float* at(std::size_t i) const { return &picture_.samples[i * std::size_t(picture_.channels)]; }

  const image::Image& picture_;
};

std::uint32_t packed(const Colour& c) {
  return std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2];
}

/// All colours that are seen, in order; more than there may be: none.
std::vector<std::uint32_t> few_colours(const Pixels& pixels) {
  std::vector<bool> known(std::size_t{1} << 24);
  std::vector<std::uint32_t> colours;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels.is_seen(i)) continue;
    const std::uint32_t colour = packed(pixels.colour(i));
    if (known[colour]) continue;
    known[colour] = true;
    colours.push_back(colour);
    if (colours.size() > pixels.most()) return {};
  }
  std::sort(colours.begin(), colours.end());
  return colours;
}

PalettePicture exactly(const Pixels& pixels, const std::vector<std::uint32_t>& colours) {
  PalettePicture result;
  for (std::size_t k = 0; k < colours.size(); ++k)
    result.colours[pixels.first() + k] = 0xFF000000 | colours[k];
  result.indices.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels.is_seen(i)) continue;
    const auto at = std::lower_bound(colours.begin(), colours.end(), packed(pixels.colour(i)));
    result.indices[i] = std::uint8_t(pixels.first() + std::size_t(at - colours.begin()));
  }
  return result;
}

std::vector<Cell> cells_of(const Pixels& pixels) {
  std::vector<Cell> all(kCells);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels.is_seen(i)) continue;
    const Colour colour = pixels.colour(i);
    Cell& cell = all[cell_of(colour)];
    cell.count += 1;
    for (std::size_t c = 0; c < 3; ++c) cell.sum[c] += colour[c];
  }
  std::vector<Cell> used;
  for (std::size_t i = 0; i < kCells; ++i) {
    all[i].index = std::uint32_t(i);
    if (all[i].count > 0) used.push_back(all[i]);
  }
  return used;
}

PalettePicture in_groups(const Pixels& pixels) {
  PalettePicture result;
  std::vector<Cell> cells = cells_of(pixels);
  const std::vector<Group> groups = groups_of(cells, pixels.most());
  std::vector<std::uint8_t> index_of(kCells, 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto index = std::uint8_t(pixels.first() + g);
    std::uint32_t argb = 0xFF;
    for (const double m : groups[g].mean) argb = argb << 8 | std::uint32_t(m + 0.5);
    result.colours[index] = argb;
    for (std::size_t i = groups[g].begin; i < groups[g].end; ++i) index_of[cells[i].index] = index;
  }
  result.indices.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.is_seen(i)) result.indices[i] = index_of[cell_of(pixels.colour(i))];
  }
  return result;
}

}  // namespace

PalettePicture in_palette(const image::Image& picture) {
  const Pixels pixels(picture);
  const std::vector<std::uint32_t> few = few_colours(pixels);
  return few.empty() ? in_groups(pixels) : exactly(pixels, few);
}

}  // namespace knotreel::video
