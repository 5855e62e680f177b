// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>

#include "knotreel/features/known_corners.h"

namespace knotreel::track {

/// A drawing and what was found in it. Opaque.
struct KnownDrawing;

/// What find_drawn_curves() has found out about the last drawings, so that it need not find it again where
/// the next one is the same, bit for bit. Curves are the same with it and without. Safe to use from several
/// threads.
class KnownDrawings {
 public:
  features::KnownCorners& corners() { return corners_; }

  /// The one that was kept last, or null.
  std::shared_ptr<const KnownDrawing> last() const;
  /// @param drawing null: there is none any more, and its memory is free.
  void keep(std::shared_ptr<const KnownDrawing> drawing);

 private:
  features::KnownCorners corners_;
  mutable std::mutex mutex_;
  std::shared_ptr<const KnownDrawing> last_;
};

}  // namespace knotreel::track
