// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/fit_watch.h"

namespace knotreel::track {

namespace {

constexpr double kOfLate = 0.2;  // weight of a frame in shares of those of late
constexpr int kShortGroup = 6;   // warm frames, of a dear group
constexpr int kShortCheap = 3;   // and of others
constexpr int kCheapGroups = 2;  // that count as one cold frame in vain

}  // namespace

void FitWatch::start_group(double psnr, Start start, bool dear) {
  last_ = psnr;
  repaired_ = 0;
  const bool short_before = start == Start::kDrift && frames_ < (dear ? kShortGroup : kShortCheap);
  short_groups_ = short_before ? short_groups_ + 1 : 0;
  frames_ = 0;
  repeated_ = 0;
  vain_ = dear ? short_groups_ : short_groups_ / kCheapGroups;
  looked(psnr);
}

bool FitWatch::needs_repair(double psnr) const {
  if (!has_fallen(psnr)) return false;
  return last_ - psnr > options_.repair_below * (1 + options_.repair_patience * repaired_) ||
         has_drifted(psnr);
}

void FitWatch::end_frame(double psnr, bool repaired) {
  last_ = psnr;
  ++frames_;
  repeated_ = 0;
  repaired_ += kOfLate * ((repaired ? 1 : 0) - repaired_);
}

bool FitWatch::is_time_to_look(double psnr) {
  return ++since_look_ >= looks_apart() * options_.look_interval || has_drifted(psnr);
}

void FitWatch::looked(double psnr) {
  drift_from_ = psnr;
  since_look_ = 0;
}

}  // namespace knotreel::track
