// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "knotreel/knots/target.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::track {

/// What a cold frame promises without being made (docs/decisions/0015): the PSNR of the last one, less what
/// pictures have become harder since. Targets are those of the picture that is asked about, functions the
/// control points that a frame may have.
class ColdOutlook {
 public:
  explicit ColdOutlook(const vectorize::Options& cold) : cold_(cold) {}

  /// A cold frame begins a group. How hard its picture is, is found once the next one is there.
  /// The group may have another bound than the one before, with which a picture is as hard as it is.
  void start_group(double psnr) {
    last_ = {psnr, std::nullopt};
    difficulty_.reset();
  }

  /// To be called before the target changes, in case it is that of a cold frame.
  void look_back(const knots::Target& target, std::size_t functions);

  /// From here on another picture is asked about.
  void next_picture() { difficulty_.reset(); }

  /// PSNR of a cold frame, about, but at least what is good enough if the functions allow that; dB.
  double expected_psnr(const knots::Target& target, std::size_t functions);

  /// A cold frame of the picture was made, and was no better.
  void made_in_vain(double psnr, const knots::Target& target, std::size_t functions);

 private:
  double difficulty_of(const knots::Target& target, std::size_t functions);

  vectorize::Options cold_;
  std::optional<double> difficulty_;  ///< of the picture, once it was asked for
  struct {
    double psnr = 0;
    std::optional<double> difficulty;
  } last_;  ///< cold frame, that began the group or was made in vain
};

}  // namespace knotreel::track
