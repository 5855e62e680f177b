// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>

#include "knotreel/features/known_corners.h"
#include "knotreel/image/enlarge.h"

namespace knotreel::track {

/// What find_drawn_curves() has found out about the last drawings, so that it need not find it again where
/// the next one is the same, bit for bit. Curves are the same with it and without. Safe to use from several
/// threads.
class KnownDrawings {
 public:
  features::KnownCorners& corners() { return corners_; }

  /// The picture twice as wide and high (image::enlarge_twofold()), which is what is known of then.
  std::shared_ptr<const image::Enlarged> enlarged(const image::Image& picture);

 private:
  features::KnownCorners corners_;
  std::mutex mutex_;
  std::shared_ptr<const image::Enlarged> enlarged_;  ///< the last one that was asked for
};

}  // namespace knotreel::track
