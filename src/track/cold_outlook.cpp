// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/cold_outlook.h"

#include <algorithm>
#include <cmath>

#include "track/difficulty.h"

namespace knotreel::track {

namespace {

constexpr double kSquaredOverMec = 2;  // mean squared error over the square of the MEC, about
constexpr double kLeast = 1;           // squared levels, of the whole picture

}  // namespace

double ColdOutlook::difficulty_of(const knots::Target& target, std::size_t functions) {
  if (!difficulty_) difficulty_ = difficulty(target, cold_, functions);
  return *difficulty_;
}

void ColdOutlook::look_back(const knots::Target& target, std::size_t functions) {
  if (!last_.difficulty) last_.difficulty = difficulty_of(target, functions);
}

double ColdOutlook::expected_psnr(const knots::Target& target, std::size_t functions) {
  const double now = difficulty_of(target, functions);
  const double by_last = last_.psnr - 10 * std::log10((now + kLeast) / (*last_.difficulty + kLeast));
  const double pixels = static_cast<double>(target.image().pixel_count());
  const double good_enough = pixels * kSquaredOverMec * cold_.mec * cold_.mec;
  if (now > good_enough) return by_last;
  return std::max(by_last, 10 * std::log10(255.0 * 255 * target.channels() * pixels / good_enough));
}

void ColdOutlook::made_in_vain(double psnr, const knots::Target& target, std::size_t functions) {
  last_ = {psnr, difficulty_of(target, functions)};
}

}  // namespace knotreel::track
