// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/profile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace knotreel::features {
namespace {

/// One channel of the picture along the row or column across the edge, so turned that it rises. Positions are
/// relative to the pixel; beyond the sides of the picture its last sample goes on.
class Profile {
 public:
  Profile(const GradientField& field, int x, int y, Vec2 gradient)
      : field_(field),
        x_(x),
        y_(y),
        channel_(field.channel[field.at(x, y)]),
        across_x_(is_vertical(gradient)),
        sign_((across_x_ ? gradient.x : gradient.y) < 0 ? -1 : 1) {
    std::array<double, 2 * kReach + 2> raw{};
    for (int k = -kReach; k <= kReach + 1; ++k) {
      raw[std::size_t(k + kReach)] =
          sign_ * field.raw(across_x_ ? clamped_x(k) : x, across_x_ ? y : clamped_y(k), channel_);
    }
    for (std::size_t k = 0; k < steps_.size(); ++k) steps_[k] = std::max(0.0, raw[k + 1] - raw[k]);
  }

  double smooth(int k) const {
    return sign_ * double{field_.plane(
                       channel_)[field_.at(across_x_ ? clamped_x(k) : x_, across_x_ ? y_ : clamped_y(k))]};
  }
  /// From sample k of the picture to the next, so it lies at k + 0.5; zero where the profile falls.
  /// @param k -kReach..kReach
  double step(int k) const { return steps_[std::size_t(k + kReach)]; }
  static constexpr int kReach = 3;

 private:
  int clamped_x(int k) const { return std::clamp(x_ + k, 0, field_.width - 1); }
  int clamped_y(int k) const { return std::clamp(y_ + k, 0, field_.height - 1); }

  const GradientField& field_;
  int x_;
  int y_;
  int channel_;
  bool across_x_;
  double sign_;
  std::array<double, 2 * kReach + 1> steps_;
};

/// Place of the edge along the profile: centroid of the steps around the steepest one of the two at the
/// pixel, as far as they decrease, at most two away, and above the lower of the two ends. For an antialiased
/// edge, which has two steps or three, the centroid is exact (a parabola is off by up to 0.15 px); taking off
/// the ends makes it exact for wide symmetric ones that lie on or half between pixels, too.
double edge_offset(const Profile& profile) {
  const int peak = profile.step(-1) >= profile.step(0) ? -1 : 0;
  constexpr int kSteps = 2;
  int first = peak;
  int last = peak;
  while (first > peak - kSteps && profile.step(first - 1) <= profile.step(first)) --first;
  while (last < peak + kSteps && profile.step(last + 1) <= profile.step(last)) ++last;
  const double base = std::min(profile.step(first), profile.step(last));
  double weight = 0;
  double moment = 0;
  for (int k = first; k <= last; ++k) {
    const double w = profile.step(k) - (first == last ? 0 : base);
    weight += w;
    moment += w * (k + 0.5);
  }
  // A flat top of equal steps has nothing above its ends.
  if (weight <= 0) return profile.step(peak) > 0 ? 0.5 * (first + last + 1) : 0;
  return std::clamp(moment / weight, -1.0, 1.0);
}

}  // namespace

Vec2 refine_position(const GradientField& field, int x, int y) {
  const Vec2 centre{field.origin_x + x + 0.5, field.origin_y + y + 0.5};
  const Vec2 g = field.gradient(x, y);
  // A level per ten pixels: no edge, but rounding.
  if (std::max(std::abs(g.x), std::abs(g.y)) < 0.1) return centre;
  const double offset = edge_offset(Profile(field, x, y, g));
  // The edge, a line across g, meets the row (or column) at the offset; its nearest point is the shortest way
  // there, which leaves the curves the most room.
  const double dominant = is_vertical(g) ? g.x : g.y;
  return centre + (offset * dominant / dot(g, g)) * g;
}

Transition transition(const GradientField& field, int x, int y) {
  const Vec2 g = field.gradient(x, y);
  const Profile profile(field, x, y, g);
  constexpr int kPlateau = 4;
  int first = 0;
  int last = 0;
  while (first > -kPlateau && profile.smooth(first - 1) < profile.smooth(first)) --first;
  while (last < kPlateau && profile.smooth(last + 1) > profile.smooth(last)) ++last;
  Transition result;
  result.contrast = profile.smooth(last) - profile.smooth(first);
  for (int k = -2; k <= 1; ++k) result.slope = std::max(result.slope, profile.step(k));
  // The profile crosses a slanted edge at an angle, which makes it look softer.
  const double length = norm(g);
  if (length > 0) result.contrast *= std::max(std::abs(g.x), std::abs(g.y)) / length;
  return result;
}

}  // namespace knotreel::features
