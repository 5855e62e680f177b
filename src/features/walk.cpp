// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/walk.h"

#include <algorithm>
#include <utility>

namespace knotreel::features {
namespace {

int direction_of(int step_x, int step_y) {
  for (int d = 0; d < 8; ++d) {
    if (kStepX[d] == step_x && kStepY[d] == step_y) return d;
  }
  return -1;
}

/// Pixels at the sides that walks keep away from. What lies there is the frame of a scan more often than a
/// feature, and leaves no room for faces between curve and side.
constexpr int kMargin = 2;

/// A walk does not go on to less than this share of the gradient that it comes from. At right-angled corners
/// the magnitude falls to a half; far less means that the walk has left its edge over the foot of the ridge.
constexpr float kLeastShare = 0.25F;
/// By how much that memory fades per step, so that edges may fade.
constexpr float kFading = 0.8F;

bool neighbours(const LinkMap& map, int a, int b) {
  return std::abs(map.x(a) - map.x(b)) <= 1 && std::abs(map.y(a) - map.y(b)) <= 1;
}

}  // namespace

Walker::Walker(const GradientField& field, const LinkMap& map, double threshold)
    : field_(field), map_(map), threshold_(float(threshold)), marks_(std::size_t(map.size()), 0) {}

std::vector<int> Walker::walk(int anchor) {
  stamp_ += 2;
  if (closed(anchor) || in_margin(anchor) || map_.crowded(anchor)) return {};
  marks_[std::size_t(anchor)] = stamp_;
  std::vector<int> path{anchor};
  int step_x = 1;
  int step_y = 0;
  if (is_vertical(field_.inner_gradient(at(anchor)))) std::swap(step_x, step_y);
  // The stronger way first, so that mirrored pictures have mirrored walks.
  const auto strength = [&](int next) { return next < 0 ? 0.0F : field_.magnitude[at(next)]; };
  if (strength(next_pixel(anchor, step_x, step_y)) < strength(next_pixel(anchor, -step_x, -step_y))) {
    step_x = -step_x;
    step_y = -step_y;
  }
  extend(path, step_x, step_y);
  std::reverse(path.begin(), path.end());
  extend(path, -step_x, -step_y);
  return path;
}

/// Goes on from the end of the path, until it ends.
void Walker::extend(std::vector<int>& path, int step_x, int step_y) {
  float level = 0;
  while (true) {
    const int here = path.back();
    level = std::max(kFading * level, field_.magnitude[at(here)]);
    const int next = next_pixel(here, step_x, step_y);
    if (next < 0 || map_.crowded(next) || field_.magnitude[at(next)] < kLeastShare * level) return;
    // A step around the corner of a pixel: the pixel at the corner is not needed.
    const bool shortcut = path.size() > 1 && neighbours(map_, next, path[path.size() - 2]);
    if (shortcut) {
      path.pop_back();
      marks_[std::size_t(here)] = stamp_ + 1;
    }
    if (touches_path(next, path.back())) {
      if (shortcut) path.push_back(here);
      return;
    }
    marks_[std::size_t(next)] = stamp_;
    step_x = map_.x(next) - map_.x(here);
    step_y = map_.y(next) - map_.y(here);
    path.push_back(next);
  }
}

/// @param step_x, step_y the step that led to `pixel`
int Walker::next_pixel(int pixel, int step_x, int step_y) const {
  const int heading = direction_of(step_x, step_y);
  const bool vertical = is_vertical(field_.inner_gradient(at(pixel)));
  const int along = vertical ? step_y : step_x;
  int next = kNone;
  if (along != 0) {
    const int d = vertical ? direction_of(0, along) : direction_of(along, 0);
    next = strongest(pixel, {d, (d + 1) % 8, (d + 7) % 8, 0}, 3);
  } else {
    // The edge turns here by a right angle, to either side.
    next = strongest(pixel, {(heading + 1) % 8, (heading + 7) % 8, (heading + 2) % 8, (heading + 6) % 8}, 4);
  }
  // At corners the direction of single pixels says little: straight on then.
  return next != kNone ? next : strongest(pixel, {heading, (heading + 1) % 8, (heading + 7) % 8, 0}, 3);
}

/// The strongest of the neighbours that may be entered, the first of equals; kNone if there is none, kLeaves
/// if an even stronger one lies in the margin: the edge leaves the picture there, and must not be followed
/// along the margin.
int Walker::strongest(int pixel, const int (&directions)[4], int count) const {
  int best = kNone;
  float most = 0;
  for (int k = 0; k < count; ++k) {
    const int other = map_.neighbour(pixel, directions[k]);
    const std::size_t i = at(other);
    const float magnitude = field_.magnitude[i];
    const std::int32_t mark = marks_[std::size_t(other)];
    const bool open = mark != kClosed && mark < stamp_ && magnitude >= threshold_;
    if (open && magnitude > most && same_edge(pixel, other)) {
      best = in_margin(other) ? kLeaves : other;
      most = magnitude;
    }
  }
  return best;
}

bool Walker::in_margin(int pixel) const {
  const int x = map_.x(pixel);
  const int y = map_.y(pixel);
  return x < kMargin || y < kMargin || x >= map_.width() - kMargin || y >= map_.height() - kMargin;
}

/// Gradients point to the same side: those of the two sides of a thin line do not. Both are taken of one
/// channel, because neighbours may differ in their strongest one, where one channel rises as another falls.
bool Walker::same_edge(int a, int b) const {
  const int c = field_.channel[at(a)];
  return dot(field_.inner_gradient(at(a), c), field_.inner_gradient(at(b), c)) > 0;
}

/// Some pixel around is on the path, other than its end.
bool Walker::touches_path(int pixel, int end) const {
  for (int d = 0; d < 8; ++d) {
    const int other = map_.neighbour(pixel, d);
    if (other != end && marks_[std::size_t(other)] == stamp_) return true;
  }
  return false;
}

}  // namespace knotreel::features
