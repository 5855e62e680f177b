#include <vector>

#include "fit/folds.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::fit {

namespace {

// The map may shrink areas to this share; below that it counts as about to fold.
constexpr double kLeastArea = 0.05;
constexpr double kShrink = 0.85;  // of displacements at folds, each time
constexpr int kMaxRounds = 24;

}  // namespace

std::size_t unfold_geometry(const spline::Basis& basis, std::vector<Vec2>& displacement) {
  Folds folds(basis, displacement);
  std::size_t found = folds.find(kLeastArea);
  for (int round = 0; round < kMaxRounds && found > 0; ++round) {
    const std::vector<std::uint8_t> shrink = folds.groups();
    for (std::size_t g = 0; g < displacement.size(); ++g) {
      if (shrink[g]) displacement[g] = kShrink * displacement[g];
    }
    folds.change(displacement, shrink);
    found = folds.find(kLeastArea);
  }
  return found;
}

}  // namespace knotreel::fit
