// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/colour_coarseness.h"

namespace knotreel::track {
namespace {

// dB. Another level is left later than it was come to, since every change of it rounds all colours anew.
constexpr double kFineAbove = 38.5;
constexpr double kCoarseBelow = 26;
constexpr double kLeave = 1;

}  // namespace

void ColourCoarseness::start_group(double psnr) {
  level_ = Level::kUsual;
  end_frame(psnr);
}

void ColourCoarseness::end_frame(double psnr) {
  if (psnr > kFineAbove) {
    level_ = Level::kFine;
  } else if (psnr < kCoarseBelow) {
    level_ = Level::kCoarse;
  } else if (level_ == Level::kFine ? psnr < kFineAbove - kLeave : psnr > kCoarseBelow + kLeave) {
    level_ = Level::kUsual;
  }
}

double ColourCoarseness::factor() const {
  switch (level_) {
    case Level::kFine:
      return 2.0 / 3;
    case Level::kCoarse:
      return 4.0 / 3;
    default:
      return 1;
  }
}

}  // namespace knotreel::track
