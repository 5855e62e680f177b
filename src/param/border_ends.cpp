// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/border_ends.h"

#include <algorithm>
#include <array>

namespace knotreel::param {
namespace {

/// Ends on the border keep this distance, in pixels, from the corners of the domain.
constexpr double kCornerZone = 2;
/// Pixels that a chain may be continued by before it reaches the outermost ring.
constexpr int kMostPixels = 4;
/// Shift of the end along the side from the centre of its pixel. Ends of two chains are two pixels apart or
/// more, so they stay half a pixel apart and in order.
constexpr double kMostShift = 0.75;
/// Points back along the curve over which its direction is taken.
constexpr std::size_t kLookBack = 4;

/// A side of the domain seen from a pixel.
struct Side {
  VertexPlace place;
  int dx, dy;    ///< towards it
  int distance;  ///< pixels between the pixel and the outermost ring
};

std::array<Side, 4> sides_from(const Curves& curves, int x, int y) {
  return {{{VertexPlace::kLeft, -1, 0, x},
           {VertexPlace::kRight, 1, 0, curves.width - 1 - x},
           {VertexPlace::kTop, 0, -1, y},
           {VertexPlace::kBottom, 0, 1, curves.height - 1 - y}}};
}

/// Direction of the curve at its last end; zero if it has none.
Vec2 end_direction(const Curves& curves, const Curve& curve) {
  const std::size_t n = curve.sites.size();
  const Vec2 end = curves.sites[curve.sites[n - 1]].position;
  const Vec2 before = curves.sites[curve.sites[n - 1 - std::min(kLookBack, n - 1)]].position;
  const double length = norm(end - before);
  return length > 0 ? (1 / length) * (end - before) : Vec2{};
}

/// Nearest side; of two equally near ones, that towards which the curve runs.
Side choose_side(const Curves& curves, int x, int y, Vec2 direction) {
  const std::array<Side, 4> sides = sides_from(curves, x, y);
  const auto cost = [&](const Side& s) {
    return s.distance - 0.9 * (s.dx * direction.x + s.dy * direction.y);
  };
  return *std::min_element(sides.begin(), sides.end(),
                           [&](const Side& a, const Side& b) { return cost(a) < cost(b); });
}

/// Whether a new site at a pixel would touch sites other than that it continues.
bool is_free(const Curves& curves, int x, int y, SiteIndex end, SiteIndex before_end) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const SiteIndex s = curves.site_at(x + dx, y + dy);
      if (s != kNone && s != end && s != before_end) return false;
    }
  }
  return curves.site_at(x, y) == kNone;
}

Site pixel_site(const Curves& curves, int x, int y, Vec2 shift) {
  Site site;
  site.pixel = y * curves.width + x;
  site.centre = {x + 0.5, y + 0.5};
  site.faired = site.centre + shift;
  site.position = site.faired;
  return site;
}

/// Where the curve meets a side, measured along it, for the centre of its last pixel and its position.
/// @return false within the zone of a corner.
bool place_on_side(double centre, double wanted, double size, double& along) {
  const double low = std::max(centre - kMostShift, kCornerZone);
  const double high = std::min(centre + kMostShift, size - kCornerZone);
  if (low > high) return false;
  along = std::clamp(wanted, low, high);
  return true;
}

}  // namespace

bool continue_to_border(Curves& curves, Curve& curve) {
  SiteIndex end = curve.sites.back();
  SiteIndex before_end = curve.sites[curve.sites.size() - 2];
  const Site last = curves.sites[end];
  if (last.pixel == kNoPixel) return false;
  int x = curves.x_of(last);
  int y = curves.y_of(last);
  const Vec2 direction = end_direction(curves, curve);
  const Side side = choose_side(curves, x, y, direction);
  if (side.distance > kMostPixels) return false;
  for (int i = 1; i <= side.distance; ++i) {
    const bool next_to_end = i == 1;
    if (!is_free(curves, x + i * side.dx, y + i * side.dy, next_to_end ? end : kNone,
                 next_to_end ? before_end : end)) {
      return false;
    }
  }

  // The tangent decides only where the curve is steep enough to the side; else the foot does.
  const bool along_y = side.dx != 0;
  const double steepness = along_y ? side.dx * direction.x : side.dy * direction.y;
  const double drift = (along_y ? direction.y : direction.x) / std::max(steepness, 0.5);
  const double from = along_y ? last.position.y : last.position.x;
  double along = 0;
  if (!place_on_side(along_y ? last.centre.y : last.centre.x, from + (side.distance + 0.5) * drift,
                     along_y ? curves.height : curves.width, along)) {
    return false;
  }

  const Vec2 start = last.position - last.centre;
  const double shift = along - (along_y ? last.centre.y : last.centre.x);
  for (int i = 1; i <= side.distance; ++i) {
    const double share = i / (side.distance + 0.5);
    const double s = (1 - share) * (along_y ? start.y : start.x) + share * shift;
    x += side.dx;
    y += side.dy;
    curves.at_pixel[static_cast<std::size_t>(y) * static_cast<std::size_t>(curves.width) +
                    static_cast<std::size_t>(x)] = static_cast<SiteIndex>(curves.sites.size());
    curve.sites.push_back(static_cast<SiteIndex>(curves.sites.size()));
    curves.sites.push_back(pixel_site(curves, x, y, along_y ? Vec2{0, s} : Vec2{s, 0}));
  }

  Site foot;
  foot.place = side.place;
  foot.is_vertex = true;
  const double across = side.dx + side.dy < 0 ? 0.0 : (along_y ? curves.width : curves.height);
  foot.centre = along_y ? Vec2{across, last.centre.y} : Vec2{last.centre.x, across};
  foot.faired = along_y ? Vec2{across, along} : Vec2{along, across};
  // Near a corner even the foot of the centre may be too close: then it cannot be relaxed either.
  double centre_along = 0;
  place_on_side(along_y ? last.centre.y : last.centre.x, along_y ? foot.centre.y : foot.centre.x,
                along_y ? curves.height : curves.width, centre_along);
  (along_y ? foot.centre.y : foot.centre.x) = centre_along;
  foot.position = foot.faired;
  curve.sites.push_back(static_cast<SiteIndex>(curves.sites.size()));
  curves.sites.push_back(foot);
  return true;
}

}  // namespace knotreel::param
