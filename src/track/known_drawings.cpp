// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/known_drawings.h"

#include <utility>

namespace knotreel::track {

std::shared_ptr<const image::Enlarged> KnownDrawings::enlarged(const image::Image& picture) {
  std::shared_ptr<const image::Enlarged> known;
  {
    const std::lock_guard lock(mutex_);
    known = enlarged_;
  }
  auto result = std::make_shared<const image::Enlarged>(
      image::Enlarged{picture, image::enlarge_twofold(picture, known.get())});
  const std::lock_guard lock(mutex_);
  enlarged_ = result;
  return result;
}

}  // namespace knotreel::track
