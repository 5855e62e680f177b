// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "export/patch_stream.h"

namespace knotreel::exporting {

/// Triangles as the data of a PDF shading of type 4: per vertex a flag of 8 bits, two coordinates of 24 bits
/// and the colour, 8 bits per component. A triangle that shares an edge with the one before takes one vertex.
class GouraudEncoder {
 public:
  /// @param first, count  the channels to write.
  GouraudEncoder(const Box& box, std::size_t first, std::size_t count)
      : box_(box), first_(first), count_(count) {}

  /// Entries of the shading dictionary that say how to read the data, and its colour space.
  std::string entries() const;

  /// Appends the data of a patch.
  void encode(const Patch& patch, std::vector<std::byte>& out) const;

 private:
  void put(int flag, const SurfacePoint& point, std::vector<std::byte>& out) const;

  Box box_;
  std::size_t first_;
  std::size_t count_;
};

}  // namespace knotreel::exporting
