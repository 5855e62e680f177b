// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"
#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::bench {

/// A frame of a clip of `knotreel bench` in which the camera and all else move: shaded, textured, with sharp
/// edges.
image::Image scene_picture(int width, int height, int frame = 0);

/// A knot mesh with about as many control points as frames of videos have by default, 2 % of the pixels.
mesh::KnotMesh scene_mesh(int width, int height);

}  // namespace knotreel::bench
