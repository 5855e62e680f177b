// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"

namespace knotreel::testing {

/// Feature chains made by hand: curves given as points are drawn as 8-connected chains of pixels, with their
/// positions faired as the detector does it (paper Eq. 5). What would break the promises of FeatureChains
/// is left out.
class ChainBuilder {
 public:
  ChainBuilder(int width, int height);

  /// Draws a curve through points (straight pieces). Ends that lie in the outermost ring run on to the
  /// border. Steps that would touch other chains end it.
  /// @return false, and nothing is drawn, if fewer than `least` pixels are left (8 if it is closed).
  bool add(const std::vector<Vec2>& curve, bool closed = false, std::size_t least = 2);

  /// Arms from a common node; each a curve that starts at `centre`.
  bool add_star(Vec2 centre, const std::vector<std::vector<Vec2>>& arms);

  features::FeatureChains chains;

 private:
  struct Pixel {
    int x, y;
  };
  std::vector<Pixel> draw(const std::vector<Vec2>& curve, bool closed) const;
  bool is_free(int x, int y) const;
  void push(const std::vector<Pixel>& pixels, bool closed, features::NodeIndex first,
            features::NodeIndex last);

  std::vector<bool> taken_;
};

/// A circle, or part of it, as points.
std::vector<Vec2> arc(Vec2 centre, double radius, double from = 0, double to = 6.283185307179586);

/// A picture's worth of features: random smooth curves, circles, parallel lines, stars, ends on the border.
features::FeatureChains random_chains(int width, int height, int count, unsigned seed);

/// The same chains in a mirror: x -> width - x.
features::FeatureChains mirrored(const features::FeatureChains& chains);

}  // namespace knotreel::testing
