// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>

#include "knotreel/base/vec2.h"

namespace knotreel::raster {

/// A straight piece of a feature curve, in grid pixels.
struct Chord {
  Vec2 from;
  Vec2 to;
};

/// A part of a pixel on one side of a curve.
struct PixelPart {
  double share;  ///< of the pixel's area, 0 to 1
  Vec2 centre;   ///< its centroid, in grid pixels
};
using PixelParts = std::array<PixelPart, 2>;

/// The parts of pixel (x, y) beside a curve that goes through it once, nearly straight: then a surface that
/// is smooth on both sides has about its mean over each part at the centroid of that.
/// @param chords all that meet the pixel, in any order; those of one curve have their ends in common, bit by
///               bit.
/// @return nothing if more than that meets the pixel, or less.
std::optional<PixelParts> split_pixel(std::span<const Chord> chords, int x, int y);

}  // namespace knotreel::raster
