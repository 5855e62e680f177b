// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/unchanged.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"

namespace knotreel::motion {

namespace {

int cells(int pixels) {
  return (pixels + kCellSide - 1) / kCellSide;
}

}  // namespace

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
