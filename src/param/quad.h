// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace knotreel::param {

/// The displacements of a pixel: position x, y, parameter x, y. Four floats that the compiler keeps in one
/// register: both fields obey the same equations and are solved together.
typedef float Quad __attribute__((vector_size(16)));

inline float largest(Quad q) {
  return std::fmax(std::fmax(std::fabs(q[0]), std::fabs(q[1])), std::fmax(std::fabs(q[2]), std::fabs(q[3])));
}

/// Rows of cells with a frame of one more cell, which is zero, around them: stencils need no special cases.
template <typename T>
class Framed {
 public:
  Framed() = default;
  Framed(int width, int height) : stride_(static_cast<std::size_t>(width) + 2), cells_() {
    cells_.assign(stride_ * (static_cast<std::size_t>(height) + 2), T{});
  }

  /// The cell (0, y); (-1, y) and (width, y) are of the frame, as are rows -1 and height.
  T* row(int y) { return cells_.data() + static_cast<std::size_t>(y + 1) * stride_ + 1; }
  const T* row(int y) const { return cells_.data() + static_cast<std::size_t>(y + 1) * stride_ + 1; }
  T& at(int x, int y) { return row(y)[x]; }
  const T& at(int x, int y) const { return row(y)[x]; }

 private:
  std::size_t stride_ = 0;
  std::vector<T> cells_;
};

}  // namespace knotreel::param
