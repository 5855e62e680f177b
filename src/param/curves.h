// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::param {

using SiteIndex = std::uint32_t;
inline constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// A point of feature curves: a pixel, or the end of a curve on a side of the domain. A node is one site of
/// several curves.
struct Site {
  std::int32_t pixel = kNoPixel;
  VertexPlace place = VertexPlace::kInside;
  bool is_vertex = false;       ///< of the polyline
  bool preferred = false;       ///< as features::ChainPoint
  double fairing = 1;           ///< position = centre + fairing * (faired - centre)
  Vec2 centre;                  ///< of the pixel, or its foot on the side
  Vec2 faired;                  ///< where the detector puts the curve
  Vec2 position;                ///< in the image
  Vec2 beyond;                  ///< on to the curve, as features::ChainPoint
  Vec2 parameter;               ///< on the polyline
  std::uint32_t curve = kNone;  ///< that has the site inside; kNone for nodes
  std::uint32_t index = 0;      ///< in that curve
};

struct Curve {
  std::uint32_t chain = 0;
  bool closed = false;
  bool dropped = false;
  bool stepped = false;  ///< as features::Chain
  std::vector<SiteIndex> sites;
};

/// The chains as parametrize() works on them.
struct Curves {
  int width = 0;
  int height = 0;
  std::vector<Site> sites;
  std::vector<Curve> curves;
  std::vector<SiteIndex> at_pixel;  ///< per pixel: its site or kNone

  SiteIndex site_at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return kNone;
    return at_pixel[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  }
  int x_of(const Site& s) const { return s.pixel % width; }
  int y_of(const Site& s) const { return s.pixel / width; }
};

/// Steps of a curve: one less than sites, unless it is closed.
inline std::size_t step_count(const Curve& c) {
  return c.closed ? c.sites.size() : c.sites.size() - 1;
}
inline SiteIndex site_after(const Curve& c, std::size_t i) {
  return c.sites[i + 1 < c.sites.size() ? i + 1 : 0];
}

/// Checks the chains and continues those that end on the border. Faired positions are kept kInset inside the
/// domain. Nodes, tips and ends on the border are vertices already.
/// @throws Error{kInvalidArgument} as parametrize()
Curves make_curves(const features::FeatureChains& chains);

/// Moves a site towards its pixel centre: half way, and from an eighth all the way.
/// @return false if it was there.
bool relax(Site& site);
void set_fairing(Site& site, double fairing);

}  // namespace knotreel::param
