// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/flat_share.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::features {

namespace {

constexpr float kFlat = 1;  // levels
constexpr float kSmall = 8;
constexpr float kSharp = 64;

double sharpness(const DifferenceCounts& differences) {
  const std::size_t others = std::max<std::size_t>(1, differences.large - differences.sharp);
  return static_cast<double>(differences.sharp) / static_cast<double>(others);
}

double flat_share(const DifferenceCounts& differences) {
  const std::size_t count = differences.count();
  return count == 0 ? 0 : static_cast<double>(differences.flat) / static_cast<double>(count);
}

/// The share of the flat ones, and up to 0.2 more where edges are as sharp as those of drawings: where as
/// many large differences are sharp as are not.
double drawn_score(const DifferenceCounts& differences) {
  constexpr double kOfSharpEdges = 0.2;
  return flat_share(differences) + kOfSharpEdges * std::min(1.0, sharpness(differences));
}

/// Of a row, without the pixels at the sides. @param y neither the first nor the last.
DifferenceCounts counts_of_row(const image::Image& image, int y) {
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t stride = image.row_size();
  const float* pixel = image.row(y).data() + channels;
  DifferenceCounts counts;
  for (int x = 1; x < image.width - 1; ++x, pixel += channels) {
    float most = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const float* sample = pixel + c;
      const float along = 2 * *sample - *(sample - channels) - *(sample + channels);
      const float across = 2 * *sample - *(sample - stride) - *(sample + stride);
      most = std::max({most, std::abs(along), std::abs(across)});
    }
    ++(most <= kFlat ? counts.flat : most <= kSmall ? counts.small : counts.large);
    if (most > kSharp) ++counts.sharp;
  }
  return counts;
}

/// Rows that have one above and one below.
std::size_t inner_rows(const image::Image& image) {
  return image.width < 3 || image.height < 3 ? 0 : static_cast<std::size_t>(image.height - 2);
}

bool same_row(const image::Image& a, const image::Image& b, std::size_t y) {
  const auto row = a.row(static_cast<int>(y));
  return std::memcmp(row.data(), b.row(static_cast<int>(y)).data(), row.size_bytes()) == 0;
}

/// Share of the pixels that have one of so many most frequent colours, to 8 levels: what pages are drawn on.
/// Not black, of which films have bars. Of large pictures some rows are enough.
double ground_share(const image::Image& image, std::ptrdiff_t grounds) {
  constexpr int kBits = 5;  // of a channel
  constexpr int kRows = 512;
  const int colours = image.colour_channels();
  std::vector<std::size_t> counts(std::size_t{1} << (kBits * colours));
  std::size_t pixels = 0;
  for (int y = 0; y < image.height; y += 1 + image.height / kRows) {
    for (int x = 0; x < image.width; ++x, ++pixels) {
      std::size_t cell = 0;
      for (int c = 0; c < colours; ++c) {
        const int level = static_cast<int>(std::max(0.0F, std::min(255.0F, image.at(x, y, c))));
        cell = (cell << kBits) + static_cast<std::size_t>(level >> (8 - kBits));
      }
      ++counts[cell];
    }
  }
  counts[0] = 0;
  std::ranges::partial_sort(counts, counts.begin() + grounds, std::greater<>());
  const std::size_t ground = std::accumulate(counts.begin(), counts.begin() + grounds, std::size_t{0});
  return static_cast<double>(ground) / static_cast<double>(std::max<std::size_t>(1, pixels));
}

struct SharpEdges {
  double flat;       ///< noise has none
  double sharpness;  ///< 0.37 and less in films, 0.67 where they are interlaced
};

/// Where codecs leave their traces around all of the letters, hardly anything is flat; but edges are as sharp
/// as ever.
bool has_sharp_edges(const DifferenceCounts& differences, const SharpEdges& least) {
  return flat_share(differences) >= least.flat && sharpness(differences) >= least.sharpness;
}

struct FullPage {
  double score;
  double sharpness;
  double ground;  ///< share of two colours; 0.39 and less in films
};

/// Where a page is full of lines, hardly any of its pixels are flat; but all of its edges are sharp, and the
/// paper has one colour, or paper and ink have two.
bool is_full_page(const image::Image& image, const DifferenceCounts& differences, const FullPage& least) {
  return drawn_score(differences) >= least.score && sharpness(differences) >= least.sharpness &&
         ground_share(image, 2) >= least.ground;
}

}  // namespace

SecondDifferences::SecondDifferences(const image::Image& image) : rows_(inner_rows(image)) {
  parallel_for(rows_.size(),
               [&](std::size_t row) { rows_[row] = counts_of_row(image, static_cast<int>(row) + 1); });
}

SecondDifferences::SecondDifferences(const image::Image& image, const image::Image& before,
                                     const SecondDifferences& known)
    : rows_(known.rows_) {
  std::vector<std::uint8_t> same(static_cast<std::size_t>(image.height));
  parallel_for(same.size(), [&](std::size_t y) { same[y] = same_row(image, before, y) ? 1 : 0; });
  parallel_for(rows_.size(), [&](std::size_t row) {
    if (same[row] && same[row + 1] && same[row + 2]) return;
    rows_[row] = counts_of_row(image, static_cast<int>(row) + 1);
  });
}

DifferenceCounts SecondDifferences::sum() const {
  return std::accumulate(
      rows_.begin(), rows_.end(), DifferenceCounts(),
      [](const DifferenceCounts& a, const DifferenceCounts& b) {
        return DifferenceCounts{a.flat + b.flat, a.small + b.small, a.large + b.large, a.sharp + b.sharp};
      });
}

double flat_share(const image::Image& image) {
  return flat_share(SecondDifferences(image).sum());
}

bool is_drawing(const image::Image& image) {
  return is_drawing(image, SecondDifferences(image));
}

bool is_drawing(const image::Image& image, const SecondDifferences& of_rows) {
  constexpr double kDrawnShare = 0.6;   // what is left of films by codecs has 0.5 and less
  constexpr double kDrawnScore = 0.52;  // and this up to 0.48
  constexpr double kScoreOfPage = 0.43;
  constexpr double kGroundOfPage = 0.4;  // of films with this score 0.24 and less
  const DifferenceCounts differences = of_rows.sum();
  const double score = drawn_score(differences);
  if (flat_share(differences) >= kDrawnShare || score >= kDrawnScore) return true;
  if (score >= kScoreOfPage && ground_share(image, 3) >= kGroundOfPage) return true;
  if (has_sharp_edges(differences, {.flat = 0.15, .sharpness = 0.75})) return true;
  return is_full_page(image, differences, {.score = 0.22, .sharpness = 0.2, .ground = 0.43});
}

bool may_be_drawing(const image::Image& image) {
  return may_be_drawing(image, SecondDifferences(image));
}

bool may_be_drawing(const image::Image& image, const SecondDifferences& of_rows) {
  constexpr double kLeastScore = 0.42;
  const DifferenceCounts differences = of_rows.sum();
  if (drawn_score(differences) >= kLeastScore) return true;
  if (has_sharp_edges(differences, {.flat = 0.12, .sharpness = 0.7})) return true;
  return is_full_page(image, differences, {.score = 0.19, .sharpness = 0.17, .ground = 0.41});
}

bool is_clean(const image::Image& image) {
  return is_clean(SecondDifferences(image));
}

bool is_clean(const SecondDifferences& of_rows) {
  constexpr double kMostSmall = 0.6;  // times the number of large ones
  const DifferenceCounts differences = of_rows.sum();
  return static_cast<double>(differences.small) <= kMostSmall * static_cast<double>(differences.large);
}

}  // namespace knotreel::features
