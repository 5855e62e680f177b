// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace knotreel::track {

/// How coarse the colours of the warm frames of a group are. Rounding them is an error of its own: next to
/// what a surface of low PSNR misses it is nothing, and coarse steps save bytes; next to what one of high
/// PSNR misses it shows, in PSNR and as flicker (docs/decisions, 26).
class ColourCoarseness {
 public:
  /// @param psnr  of the frame that starts the group, dB.
  void start_group(double psnr);
  /// @param psnr  of a warm frame, dB. The frames behind it may become coarser or finer.
  void end_frame(double psnr);

  /// Of the steps, as a multiple of the usual ones: 2/3, 1 or 4/3, which are 2, 3 and 4 levels.
  double factor() const;

 private:
  enum class Level : std::uint8_t { kFine, kUsual, kCoarse };
  Level level_ = Level::kUsual;
};

}  // namespace knotreel::track
