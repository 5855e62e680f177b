// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/bench_scene.h"

#include "bench_clips.h"
#include "support/bench_mesh.h"

namespace knotreel::bench {

image::Image scene_picture(int width, int height, int frame) {
  return media::bench_clip_frame("cuts", width, height, frame);
}

mesh::KnotMesh scene_mesh(int width, int height) {
  // Of degree 2, there are about two and a half functions per knot; features have some too.
  return picture_mesh(width, height, width * height / 160, 8);
}

}  // namespace knotreel::bench
