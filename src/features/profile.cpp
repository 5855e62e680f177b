#include "features/profile.h"

#include <algorithm>
#include <cmath>

namespace knotreel::features {
namespace {

/// One channel of the picture along the row or column across the edge, so turned that it rises. Positions are
/// relative to the pixel; beyond the sides of the picture its last sample goes on.
class Profile {
 public:
  Profile(const GradientField& field, int x, int y) {
    const std::size_t i = field.at(x, y);
    const bool across_x = field.vertical(i);
    stride_ = across_x ? 1 : field.width;
    before_ = across_x ? x : y;
    after_ = across_x ? field.width - 1 - x : field.height - 1 - y;
    const std::size_t offset = std::size_t(field.channel[i]) * field.pixels() + i;
    raw_ = field.raw.data() + offset;
    smooth_ = field.smooth.data() + offset;
    sign_ = (across_x ? field.gx[i] : field.gy[i]) < 0 ? -1 : 1;
  }

  double raw(int k) const { return sign_ * double{raw_[clamped(k)]}; }
  double smooth(int k) const { return sign_ * double{smooth_[clamped(k)]}; }
  /// From sample k to the next: lies at k + 0.5. Zero where the profile falls.
  double step(int k) const { return std::max(0.0, raw(k + 1) - raw(k)); }

 private:
  std::ptrdiff_t clamped(int k) const { return std::clamp(k, -before_, after_) * std::ptrdiff_t{stride_}; }

  const float* raw_;
  const float* smooth_;
  int stride_;
  int before_;
  int after_;
  double sign_;
};

/// Place of the edge along the profile: centroid of the steps around the steepest one of the two at the
/// pixel, as far as they decrease, at most two away, and above the lower of the two ends. For an antialiased
/// edge, which has two steps or three, the centroid is exact (a parabola is off by up to 0.15 px); taking off
/// the ends makes it exact for wide symmetric ones that lie on or half between pixels, too.
double edge_offset(const Profile& profile) {
  const int peak = profile.step(-1) >= profile.step(0) ? -1 : 0;
  constexpr int kReach = 2;
  int first = peak;
  int last = peak;
  while (first > peak - kReach && profile.step(first - 1) <= profile.step(first)) --first;
  while (last < peak + kReach && profile.step(last + 1) <= profile.step(last)) ++last;
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
  const std::size_t i = field.at(x, y);
  const Vec2 centre{x + 0.5, y + 0.5};
  const Vec2 g{double{field.gx[i]}, double{field.gy[i]}};
  // A level per ten pixels: no edge, but rounding.
  if (std::max(std::abs(g.x), std::abs(g.y)) < 0.1) return centre;
  const double offset = edge_offset(Profile(field, x, y));
  // The edge, a line across g, meets the row (or column) at the offset. Its nearest point, rather than that
  // one, keeps pixels of slanted edges from moving along the edge, towards each other.
  const double dominant = field.vertical(i) ? g.x : g.y;
  return centre + (offset * dominant / dot(g, g)) * g;
}

Transition transition(const GradientField& field, int x, int y) {
  const std::size_t i = field.at(x, y);
  const Profile profile(field, x, y);
  constexpr int kPlateau = 4;
  int first = 0;
  int last = 0;
  while (first > -kPlateau && profile.smooth(first - 1) < profile.smooth(first)) --first;
  while (last < kPlateau && profile.smooth(last + 1) > profile.smooth(last)) ++last;
  Transition result;
  result.contrast = profile.smooth(last) - profile.smooth(first);
  for (int k = -2; k <= 1; ++k) result.slope = std::max(result.slope, profile.step(k));
  // The profile crosses a slanted edge at an angle, which makes it look softer.
  const double dominant = std::abs(double{field.vertical(i) ? field.gx[i] : field.gy[i]});
  const double length = std::hypot(double{field.gx[i]}, double{field.gy[i]});
  if (length > 0) result.contrast *= dominant / length;
  return result;
}

}  // namespace knotreel::features
