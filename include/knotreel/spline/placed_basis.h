// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "knotreel/spline/pixel_values.h"

namespace knotreel::spline {

/// A basis at the pixels of a picture, with what it points to, for whoever fits to them or draws them.
/// Immutable, thread safe.
class PlacedBasis {
 public:
  /// @param places of the pixels, as for PixelValues. @throws likewise.
  PlacedBasis(std::shared_ptr<const Basis> basis, int width, int height, std::vector<Vec2> places)
      : basis_(std::move(basis)), places_(std::move(places)), values_(*basis_, width, height, places_) {}
  PlacedBasis(const PlacedBasis&) = delete;
  PlacedBasis& operator=(const PlacedBasis&) = delete;

  const std::shared_ptr<const Basis>& basis() const { return basis_; }
  std::span<const Vec2> places() const { return places_; }
  const PixelValues& values() const { return values_; }

 private:
  std::shared_ptr<const Basis> basis_;
  std::vector<Vec2> places_;
  PixelValues values_;
};

}  // namespace knotreel::spline
