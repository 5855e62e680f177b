// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/pixel_split.h"

#include <algorithm>
#include <cmath>
#include "base/small_vector.h"

namespace knotreel::raster {

namespace {

constexpr std::size_t kFew = 8;       // chords of a pixel, usually
constexpr double kMostDetour = 1.05;  // of a path that counts as nearly straight, to the distance of its ends
constexpr double kLeastShare = 1e-6;  // of a part that has a centroid
constexpr double kLeastLength = 1e-3;  // of a path that is more than a corner cut off

using Path = SmallVector<Vec2, kFew + 4>;

/// The part of a chord in the unit square.
struct Piece {
  std::array<Vec2, 2> ends;
  std::array<bool, 2> is_inside;  ///< rather than on a side of the square
  bool is_used = false;
};

std::optional<Piece> clipped(Vec2 a, Vec2 b) {
  double enter = 0;
  double leave = 1;
  const auto clip = [&](double from, double step) {
    if (step == 0) {
      if (from < 0 || from > 1) enter = 2;
      return;
    }
    const double t0 = -from / step;
    const double t1 = (1 - from) / step;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  };
  clip(a.x, b.x - a.x);
  clip(a.y, b.y - a.y);
  if (enter >= leave) return std::nullopt;
  const auto is_inside = [](Vec2 p) { return p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1; };
  return Piece{{enter > 0 ? a + enter * (b - a) : a, leave < 1 ? a + leave * (b - a) : b},
               {enter == 0 && is_inside(a), leave == 1 && is_inside(b)}};
}

/// The pieces one after the other, from side to side; empty if they do not make one path.
Path path_of(SmallVector<Piece, kFew>& pieces) {
  Path path;
  std::size_t sides = 0;
  for (Piece& piece : pieces) {
    for (std::size_t e = 0; e < 2; ++e) {
      if (piece.is_inside[e]) continue;
      if (sides++ > 0) continue;
      path.push_back(piece.ends[e]);
    }
  }
  if (sides != 2) return {};
  bool is_inside = true;
  while (path.size() <= pieces.size()) {
    const std::size_t before = path.size();
    for (Piece& piece : pieces) {
      for (std::size_t e = 0; e < 2 && !piece.is_used; ++e) {
        if (piece.ends[e] != path.back() || (path.size() > 1 && !piece.is_inside[e])) continue;
        piece.is_used = true;
        path.push_back(piece.ends[1 - e]);
        is_inside = piece.is_inside[1 - e];
      }
    }
    if (path.size() == before) return {};
  }
  return is_inside ? Path{} : path;
}

/// How far along the sides of the unit square a point on them is, from the origin on; corners are whole.
double along_sides(Vec2 p) {
  const std::array<double, 4> distance{std::abs(p.y), std::abs(1 - p.x), std::abs(1 - p.y), std::abs(p.x)};
  switch (std::min_element(distance.begin(), distance.end()) - distance.begin()) {
    case 0:
      return p.x;
    case 1:
      return 1 + p.y;
    case 2:
      return 3 - p.x;
    default:
      return 4 - p.y;
  }
}

/// Closes a path along the sides of the unit square.
void close_along_sides(Path& path) {
  constexpr std::array<Vec2, 4> kCorners{Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 1}};
  const double from = along_sides(path.back());
  double to = along_sides(path.front());
  if (to < from) to += 4;
  for (int corner = static_cast<int>(from) + 1; corner < to; ++corner)
    path.push_back(kCorners[static_cast<std::size_t>(corner % 4)]);
}

PixelPart part_of(const Path& polygon) {
  double area = 0;
  Vec2 moment{0, 0};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i];
    const Vec2 b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * cross(a, b);
    moment = moment + (cross(a, b) / 6) * (a + b);
  }
  const double share = std::clamp(area, 0.0, 1.0);
  return {share, share < kLeastShare ? Vec2{0.5, 0.5} : (1 / share) * moment};
}

}  // namespace

std::optional<PixelParts> split_pixel(std::span<const Chord> chords, int x, int y) {
  const Vec2 corner{static_cast<double>(x), static_cast<double>(y)};
  SmallVector<Piece, kFew> pieces;
  for (const Chord& c : chords) {
    if (const auto piece = clipped(c.from - corner, c.to - corner)) pieces.push_back(*piece);
  }
  Path path = path_of(pieces);
  if (path.empty()) return std::nullopt;
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += norm(path[i] - path[i - 1]);
  if (length < kLeastLength || length > kMostDetour * norm(path.back() - path.front())) return std::nullopt;
  close_along_sides(path);
  PixelPart one = part_of(path);
  PixelPart other{1 - one.share, {0.5, 0.5}};
  if (other.share > kLeastShare) other.centre = (1 / other.share) * (other.centre - one.share * one.centre);
  one.centre = one.centre + corner;
  other.centre = other.centre + corner;
  return PixelParts{one, other};
}

}  // namespace knotreel::raster
