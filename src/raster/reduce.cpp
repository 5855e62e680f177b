// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/reduce.h"

#include <algorithm>
#include <vector>

#include "knotreel/base/parallel.h"
#include "raster/colour_mean.h"

namespace knotreel::raster {
namespace {

class Reducer {
 public:
  Reducer(const Part& part, Reduction by, const DrawFine& draw) : part_(part), by_(by), draw_(draw) {}

  /// The fine pixels of whole rows fit into memory.
  void whole_rows(int row_begin, int row_end) {
    const int columns = part_.column_end - part_.column_begin;
    draw(row_begin * by_.y, row_end * by_.y, part_.column_begin, part_.column_end);
    parallel_for(static_cast<std::size_t>(row_end - row_begin), [&](std::size_t r) {
      const int row = row_begin + static_cast<int>(r);
      for (int c = 0; c < columns; ++c) {
        ColourMean mean(part_.channels);
        add(mean, c, columns, static_cast<int>(r) * by_.y, by_.y);
        mean.store(part_.at(part_.column_begin + c, row));
      }
    });
  }

  /// Pixels of one row, whose fine pixels are drawn in bands.
  void in_bands(int row, int column_begin, int column_end, int band) {
    const int columns = column_end - column_begin;
    std::vector<ColourMean> means(static_cast<std::size_t>(columns), ColourMean(part_.channels));
    for (int y = 0; y < by_.y; y += band) {
      const int rows = std::min(band, by_.y - y);
      draw(row * by_.y + y, row * by_.y + y + rows, column_begin, column_end);
      parallel_for(means.size(),
                   [&](std::size_t c) { add(means[c], static_cast<int>(c), columns, 0, rows); });
    }
    for (int c = 0; c < columns; ++c)
      means[static_cast<std::size_t>(c)].store(part_.at(column_begin + c, row));
  }

 private:
  void draw(int fine_row_begin, int fine_row_end, int column_begin, int column_end) {
    const Region fine{fine_row_begin, fine_row_end, column_begin * by_.x, column_end * by_.x};
    fine_.resize(fine.pixel_count() * part_.channels);
    draw_(fine, fine_.data());
  }

  /// Adds those of the fine rows drawn last that belong to a pixel. @param column, columns of what was drawn.
  void add(ColourMean& mean, int column, int columns, int fine_row, int rows) const {
    const auto width = static_cast<std::size_t>(columns) * static_cast<std::size_t>(by_.x);
    const auto left = static_cast<std::size_t>(column) * static_cast<std::size_t>(by_.x);
    for (int y = fine_row; y < fine_row + rows; ++y) {
      const float* from = fine_.data() + (static_cast<std::size_t>(y) * width + left) * part_.channels;
      for (int x = 0; x < by_.x; ++x, from += part_.channels) mean.add(from, 1);
    }
  }

  const Part& part_;
  Reduction by_;
  const DrawFine& draw_;
  std::vector<float> fine_;
};

/// How many of `each` samples may be held at once.
int number_of(std::size_t each) {
  return std::max(1, static_cast<int>(kMostFine / std::max<std::size_t>(each, 1)));
}

}  // namespace

void reduce_rows(const Part& part, Reduction by, const DrawFine& draw) {
  Reducer reducer(part, by, draw);
  const std::size_t fine_row = static_cast<std::size_t>(by.x) * part.channels;  // of one pixel
  const std::size_t pixel = fine_row * static_cast<std::size_t>(by.y);
  if (part.columns() * pixel <= kMostFine) {
    const int rows = number_of(part.columns() * pixel);
    for (int row = part.row_begin; row < part.row_end; row += rows)
      reducer.whole_rows(row, std::min(row + rows, part.row_end));
    return;
  }
  const int columns = number_of(pixel);
  for (int row = part.row_begin; row < part.row_end; ++row) {
    for (int column = part.column_begin; column < part.column_end; column += columns) {
      const int end = std::min(column + columns, part.column_end);
      reducer.in_bands(row, column, end, number_of(fine_row * static_cast<std::size_t>(end - column)));
    }
  }
}

}  // namespace knotreel::raster
