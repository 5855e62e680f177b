// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/cut.h"

#include <algorithm>
#include <vector>

#include "knotreel/base/parallel.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

/// Side of the cells, in pixels, whose means are compared: noise and the finest texture are averaged away.
constexpr std::size_t kCell = 4;

/// Side of the blocks, in cells. Texture is what is left when the mean of a block is taken off.
constexpr std::size_t kBlock = 8;

/// Variance of cells, in squared levels, that every block has for sure, so that flat pictures are alike.
constexpr double kFlat = 4;

/// Means of the cells of a picture, row-major; those at the right and lower border may be smaller.
struct Cells {
  std::size_t columns;
  std::size_t rows;
  std::vector<double> mean;
};

Cells cells_of(const Luma& luma) {
  const auto width = std::size_t(luma.width);
  const auto height = std::size_t(luma.height);
  Cells cells{(width + kCell - 1) / kCell, (height + kCell - 1) / kCell, {}};
  cells.mean.resize(cells.columns * cells.rows);
  parallel_for(cells.rows, [&](std::size_t row) {
    const std::size_t end = std::min(height, (row + 1) * kCell);
    std::vector<unsigned> sums(cells.columns);
    for (std::size_t y = row * kCell; y < end; ++y) {
      for (std::size_t x = 0; x < width; ++x) sums[x / kCell] += luma.v[y * width + x];
    }
    for (std::size_t column = 0; column < cells.columns; ++column) {
      const std::size_t pixels =
          (std::min(width, (column + 1) * kCell) - column * kCell) * (end - row * kCell);
      cells.mean[row * cells.columns + column] = double(sums[column]) / double(pixels);
    }
  });
  return cells;
}

/// Second central moments of two pictures, over cells.
struct Moments {
  double aa = 0;
  double bb = 0;
  double ab = 0;
};

Moments block_moments(const Cells& a, const Cells& b, std::size_t left, std::size_t top) {
  const std::size_t right = std::min(a.columns, left + kBlock);
  const std::size_t bottom = std::min(a.rows, top + kBlock);
  Moments m;
  double sum_a = 0;
  double sum_b = 0;
  for (std::size_t y = top; y < bottom; ++y) {
    for (std::size_t i = y * a.columns + left; i < y * a.columns + right; ++i) {
      sum_a += a.mean[i];
      sum_b += b.mean[i];
      m.aa += a.mean[i] * a.mean[i];
      m.bb += b.mean[i] * b.mean[i];
      m.ab += a.mean[i] * b.mean[i];
    }
  }
  const auto n = double((right - left) * (bottom - top));
  const double flat = n * kFlat;
  return {m.aa - sum_a * sum_a / n + flat, m.bb - sum_b * sum_b / n + flat, m.ab - sum_a * sum_b / n + flat};
}

/// The mean of the variances, not their root, is what covariance is measured by: texture that comes out of
/// nothing is a change, and light that changes by a third in one frame still is hardly any.
double unlikeness(const Cells& a, const Cells& b) {
  double together = 0;
  double apart = 0;
  for (std::size_t top = 0; top < a.rows; top += kBlock) {
    for (std::size_t left = 0; left < a.columns; left += kBlock) {
      const Moments m = block_moments(a, b, left, top);
      together += m.ab;
      apart += 0.5 * (m.aa + m.bb);
    }
  }
  return 1 - std::clamp(together / apart, 0.0, 1.0);
}

}  // namespace

double unlikeness(const Luma& before, const Luma& moved) {
  check_sizes(before, moved);
  return unlikeness(cells_of(before), cells_of(moved));
}

bool is_cut(double unlikeness, const CutOptions& options) {
  return options.threshold < 1 && unlikeness >= options.threshold;
}

}  // namespace knotreel::motion
