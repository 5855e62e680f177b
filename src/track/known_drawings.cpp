// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/known_drawings.h"

#include <utility>

namespace knotreel::track {

std::shared_ptr<const KnownDrawing> KnownDrawings::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

void KnownDrawings::keep(std::shared_ptr<const KnownDrawing> drawing) {
  {
    const std::lock_guard lock(mutex_);
    std::swap(last_, drawing);
  }
  // What was there before goes here, without the lock.
}

}  // namespace knotreel::track
