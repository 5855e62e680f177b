// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

/// Faces that begin with their smallest knot, sorted.
inline std::vector<Face> canonical(std::vector<Face> faces) {
  for (Face& f : faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace knotreel::mesh
