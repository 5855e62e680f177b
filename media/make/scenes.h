// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>

#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"

/// Moving scenes of our own, for clips. Scene units: what is shown is 16 wide and 9 high, x to the right, y
/// down, z towards the viewer, who is far away. Times are seconds.
namespace knotreel::media {

using Colour = std::array<double, 3>;  ///< red, green, blue; 0 to 1, may be beyond

/// Three shaded balls before a textured wall. @param t of each ball, which is all that moves.
Colour balls_scene(double x, double y, const std::array<double, 3>& t, Vec2 wall_shift);

/// A turning box in the sky above hills that pass by.
Colour hills_scene(double x, double y, double t);

/// Flat colours with dark outlines: clouds, and a creature that hops.
Colour cartoon_scene(double x, double y, double t);

/// RGB; each pixel is the mean of samples x samples.
/// @param scene  colour at a place of the picture, 0 to 1 from left to right and from top to bottom.
image::Image draw_scene(int width, int height, int samples,
                        const std::function<Colour(double u, double v)>& scene);

}  // namespace knotreel::media
