// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/track/tracker.h"

namespace knotreel::track {

/// How good the frames of a group are, one after the other, and what that calls for: a repair, edits for the
/// next frame, or a look whether a cold frame would be better. All PSNR in dB.
class FitWatch {
 public:
  explicit FitWatch(const TrackOptions& options) : options_(options) {}

  /// @param start why the group begins. If groups in a row that began by drift did not last, the next looks
  /// wait as if as many cold frames had been made in vain, half as many unless those are dear.
  /// @param dear such cold frames take long to make
  void start_group(double psnr, Start start, bool dear);

  /// Whether a frame is worse than the one before by what a repair is for.
  bool has_fallen(double psnr) const { return last_ - psnr > options_.repair_below; }

  /// The same, where repairs are rare. What falls so often that it should be left alone is repaired all the
  /// same before a cold frame is made.
  bool needs_repair(double psnr) const;

  /// Whether the knots should be put elsewhere for the next frame. @param repaired that was done already.
  bool needs_mending(double psnr, bool repaired) const {
    return !repaired && last_ - psnr > options_.mend_below;
  }

  /// The frame is done with.
  void end_frame(double psnr, bool repaired);

  /// The frame was that before once more, which tells nothing but that the group lasts.
  void end_repeated_frame() {
    ++frames_;
    ++repeated_;
  }

  /// Whether the picture has just been the same for so long that it is held, not one of an animation with few
  /// pictures per second.
  bool is_held() const { return repeated_ == kHeld; }

  /// Counts the frame. Whether to look if a cold frame would be better: the fit has fallen, or it is long
  /// since the last look (the picture may have become easier). Each cold frame in vain makes the next look
  /// wait for a deeper fall, or longer.
  bool is_time_to_look(double psnr);

  /// From here on falls and frames count anew.
  void looked(double psnr);

  void made_cold_frame_in_vain() { ++vain_; }

  /// Of the frame before.
  double last() const { return last_; }

 private:
  static constexpr int kHeld = 5;  ///< repeated frames

  bool has_drifted(double psnr) const { return psnr < drift_from_ - looks_apart() * options_.drift; }
  int looks_apart() const { return vain_ > 1 ? vain_ : 1; }

  TrackOptions options_;
  double last_ = 0;
  double drift_from_ = 0;  ///< that a fall counts from
  double repaired_ = 0;    ///< share of the frames of late that were
  int since_look_ = 0;     ///< frames
  int vain_ = 0;           ///< cold frames of this group that were no better, and short groups before it
  int frames_ = 0;         ///< warm ones of this group
  int repeated_ = 0;       ///< frames in a row
  int short_groups_ = 0;   ///< in a row
};

}  // namespace knotreel::track
