// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "knotreel/base/vec2.h"

namespace knotreel::exporting {

/// Colours of one to three channels.
using Rgb = std::array<double, 3>;

/// What SVG can fill a path with: a colour that changes linearly along one direction, or not at all.
struct Paint {
  Rgb colour{};          ///< at `centre`
  Rgb slope{};           ///< change per pixel along `direction`
  Vec2 centre;           ///< pixels of the picture
  Vec2 direction{1, 0};  ///< of length 1

  double at(Vec2 x, std::size_t channel) const {
    return colour[channel] + slope[channel] * dot(direction, x - centre);
  }
};

/// Integrals over a region of what a paint that fits best depends on: area, positions, colours and their
/// products.
struct Moments {
  double area = 0;
  Vec2 x;
  double xx = 0, xy = 0, yy = 0;
  Rgb colour{};
  std::array<Vec2, 3> x_colour{};
  double squares = 0;

  Moments& operator+=(const Moments& other);
};

/// Of a triangle with linear colours.
Moments moments_of(const std::array<Vec2, 3>& x, const std::array<Rgb, 3>& colour);

struct PaintFit {
  Paint paint;
  double squared_error = 0;  ///< integral over the region, of all channels
};

/// The paint with the least squared error.
PaintFit fit_paint(const Moments& moments);

/// Of the differences between a paint and the colours of a region, all channels together.
double root_mean_square(const Paint& paint, const Moments& moments);

}  // namespace knotreel::exporting
