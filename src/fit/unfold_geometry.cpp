// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include "fit/folds.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::fit {

namespace {

// The map may shrink areas to this share; below that it counts as about to fold.
constexpr double kLeastArea = 0.05;
constexpr double kMostShrunk = 0.021;  // of displacements at folds; there is no fold where all are 0

}  // namespace

std::size_t unfold_geometry(const spline::Basis& basis, std::vector<Vec2>& displacement, double shrink) {
  Folds folds(basis, displacement);
  std::size_t found = folds.find(kLeastArea);
  for (double left = 1; left > kMostShrunk && found > 0; left *= shrink) {
    folds.shrink(folds.groups(), shrink);
    found = folds.find(kLeastArea);
  }
  displacement = folds.displacement();
  return found;
}

}  // namespace knotreel::fit
