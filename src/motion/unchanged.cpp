// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/unchanged.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::motion {

namespace {

int cells(int pixels) {
  return (pixels + kCellSide - 1) / kCellSide;
}

}  // namespace

std::vector<std::uint8_t> unchanged_cells(const image::Image& before, const image::Image& now) {
  if (before.width != now.width || before.height != now.height || before.channels != now.channels)
    throw Error(ErrorKind::kInvalidArgument, "two pictures of a video differ in size");
  image::check_image(before);
  image::check_image(now);
  const auto columns = static_cast<std::size_t>(cells(now.width));
  const auto rows = static_cast<std::size_t>(cells(now.height));
  std::vector<std::uint8_t> result(columns * rows, 1);
  const std::size_t row_size = now.row_size();
  const auto cell_size = static_cast<std::size_t>(kCellSide * now.channels);
  parallel_for(rows, [&](std::size_t row) {
    const std::size_t last = std::min((row + 1) * kCellSide, static_cast<std::size_t>(now.height));
    for (std::size_t y = row * kCellSide; y < last; ++y) {
      const float* const a = before.samples.data() + y * row_size;
      const float* const b = now.samples.data() + y * row_size;
      for (std::size_t c = 0; c < columns; ++c) {
        const std::size_t from = c * cell_size;
        const std::size_t bytes = (std::min(from + cell_size, row_size) - from) * sizeof(float);
        if (std::memcmp(a + from, b + from, bytes) != 0) result[row * columns + c] = 0;
      }
    }
  });
  return result;
}

void Rest::start(int width, int height) {
  columns_ = cells(width);
  rows_ = cells(height);
  age_.assign(static_cast<std::size_t>(columns_ * rows_), 0);
  add(age_);
}

void Rest::add(const std::vector<std::uint8_t>& unchanged) {
  if (unchanged.size() != age_.size())
    throw Error(ErrorKind::kInvalidArgument, "two pictures of a video differ in size");
  const std::size_t stride = static_cast<std::size_t>(columns_) + 1;
  restless_.assign(stride * (static_cast<std::size_t>(rows_) + 1), 0);
  for (std::size_t row = 0, i = 0; row < static_cast<std::size_t>(rows_); ++row) {
    std::uint32_t sum = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns_); ++c, ++i) {
      age_[i] = unchanged[i] ? static_cast<std::uint8_t>(std::min(age_[i] + 1, frames_)) : std::uint8_t{0};
      sum += age_[i] < frames_ ? 1 : 0;
      restless_[(row + 1) * stride + c + 1] = restless_[row * stride + c + 1] + sum;
    }
  }
}

double Rest::share() const {
  return age_.empty() ? 0 : 1 - static_cast<double>(restless_.back()) / static_cast<double>(age_.size());
}

bool Rest::holds(Vec2 low, Vec2 high) const {
  if (age_.empty()) return false;
  const auto cell = [](double at, int count) {
    return static_cast<std::size_t>(std::clamp(std::floor(at / kCellSide), 0.0, count - 1.0));
  };
  const std::size_t stride = static_cast<std::size_t>(columns_) + 1;
  const std::size_t left = cell(low.x, columns_);
  const std::size_t right = cell(high.x, columns_) + 1;
  const std::size_t top = cell(low.y, rows_) * stride;
  const std::size_t bottom = (cell(high.y, rows_) + 1) * stride;
  return restless_[bottom + right] + restless_[top + left] ==
         restless_[bottom + left] + restless_[top + right];
}

}  // namespace knotreel::motion
