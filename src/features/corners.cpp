// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/corners.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "features/fan.h"
#include "features/known_fans.h"
#include "features/straight_side.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/features/scale.h"

namespace knotreel::features {
namespace {

/// Turns are told between points so many steps apart.
constexpr std::size_t kArm = 4;
/// A corner is within so many pixels of the picture of where the curve was found, and of where its lines
/// meet.
constexpr double kFarthest = 3;
constexpr double kMostChange = 1;
/// Sine of the angle from a side to what the picture has for it: a blunt wedge fits a corner that is round.
constexpr double kMostRotation = 0.06;
/// Whatever turns by so much, in radians, between straight sides is no arc.
constexpr double kNoArc = 0.9;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// One side of a corner.
struct Arm {
  std::size_t chain = 0;
  ChainWalk walk;
  StraightSide side;
};

/// A place where straight sides meet: inside a chain, or at a node.
struct Corner {
  Vec2 found;  ///< where the detector has it
  std::vector<Arm> arms;
  Vec2 position;
  double error = 0;  ///< the less, the better
};

/// The point with the least squared distance to the lines of all arms; nothing if they are parallel.
std::optional<Vec2> meeting_point(const std::vector<Arm>& arms) {
  double xx = 0;
  double xy = 0;
  double yy = 0;
  Vec2 right;
  for (const Arm& arm : arms) {
    const Vec2 normal{-arm.side.away.y, arm.side.away.x};
    xx += normal.x * normal.x;
    xy += normal.x * normal.y;
    yy += normal.y * normal.y;
    right = right + dot(normal, arm.side.point) * normal;
  }
  const double determinant = xx * yy - xy * xy;
  if (determinant < 0.01) return std::nullopt;
  return Vec2{(yy * right.x - xy * right.y) / determinant, (xx * right.y - xy * right.x) / determinant};
}

/// Arms in the order of their angles.
void sort_around(std::vector<Arm>& arms) {
  std::sort(arms.begin(), arms.end(), [](const Arm& a, const Arm& b) {
    return std::atan2(a.side.away.y, a.side.away.x) < std::atan2(b.side.away.y, b.side.away.x);
  });
}

double distance_found(const Corner& corner) {
  return norm(corner.position - corner.found);
}

/// Where the lines of the arms meet, if they lead there.
bool guess_position(double scale, Corner& corner) {
  const std::optional<Vec2> meeting = meeting_point(corner.arms);
  if (!meeting) return false;
  corner.position = *meeting;
  if (distance_found(corner) > scale * kFarthest) return false;
  // Lines lead to the corner, and do not run past it.
  return std::all_of(corner.arms.begin(), corner.arms.end(), [&](const Arm& arm) {
    return dot(arm.walk.at(arm.side.gap) - *meeting, arm.side.away) >= 0.2;
  });
}

/// From a guess: near to where the lines of the arms meet, if the picture says so, too.
/// @param scale  pixels of the chains per pixel of the picture
/// @param known    may be null
bool find_position(const image::Image& image, double scale, double most_error, KnownCorners::Fans* known,
                   Corner& corner) {
  const Vec2 start = corner.position;
  sort_around(corner.arms);
  Fan fan{(1 / scale) * start, {}};
  std::vector<Vec2> through;
  for (const Arm& arm : corner.arms) {
    fan.rays.push_back(arm.side.away);
    through.push_back((1 / scale) * arm.side.point);
  }
  const std::optional<FanFit> fit = known ? known->fit(image, fan, through) : fit_fan(image, fan, through);
  if (!fit || fit->error > most_error || norm(fit->fan.tip - fan.tip) > kMostChange) return false;
  for (std::size_t i = 0; i < corner.arms.size(); ++i) {
    if (std::abs(cross(corner.arms[i].side.away, fit->fan.rays[i])) > kMostRotation) return false;
  }
  corner.position = scale * fit->fan.tip;
  for (std::size_t i = 0; i < corner.arms.size(); ++i) corner.arms[i].side.away = fit->fan.rays[i];
  corner.error = fit->error + 0.01 * distance_found(corner);
  return true;
}

/// All points around a corner lead to it. Of those, one behind the other, whose lines meet at about the same
/// place, keeps the ones that are nearest to it.
void keep_nearest(double scale, std::vector<Corner>& guesses) {
  constexpr double kSamePlace = 0.7;  // px of the picture
  constexpr std::ptrdiff_t kMost = 2;
  std::vector<Corner> kept;
  for (auto first = guesses.begin(); first != guesses.end();) {
    auto last = first + 1;
    while (last != guesses.end() && norm(last->position - (last - 1)->position) < scale * kSamePlace) ++last;
    std::stable_sort(first, last,
                     [](const Corner& a, const Corner& b) { return distance_found(a) < distance_found(b); });
    std::move(first, first + std::min(kMost, last - first), std::back_inserter(kept));
    first = last;
  }
  guesses = std::move(kept);
}

/// Along a row or column of pixels, where even steps say where an edge is.
bool is_level(const StraightSide& side) {
  return std::min(std::abs(side.away.x), std::abs(side.away.y)) < 0.02;
}

/// Cosine of the turn at a point of a chain; 1 near the ends of an open one.
double straightness(const Chain& chain, std::size_t i) {
  const ChainWalk back(chain, i, false);
  const ChainWalk on(chain, i, true);
  if (back.steps() < kArm || on.steps() < kArm) return 1;
  const Vec2 a = on.at(0) - back.at(kArm);
  const Vec2 b = on.at(kArm) - on.at(0);
  return dot(a, b) / (norm(a) * norm(b));
}

class Sharpener {
 public:
  Sharpener(const image::Image& image, FeatureChains& chains, const CornerOptions& options,
            KnownCorners::Fans* known)
      : image_(image), scale_(scale_of(chains, image)), chains_(chains), options_(options), known_(known) {
    for (const Chain& chain : chains.chains) taken_.emplace_back(chain.points.size(), false);
  }

  std::size_t run() {
    std::size_t count = place(at_nodes());
    std::vector<std::vector<Corner>> found(chains_.chains.size());
    parallel_for(found.size(), [&](std::size_t c) { found[c] = inside(c); });
    for (std::vector<Corner>& corners : found) count += place(std::move(corners));
    return count;
  }

 private:
  std::optional<Arm> arm(std::size_t chain, std::size_t from, bool forward) const {
    const ChainWalk walk(chains_.chains[chain], from, forward);
    const std::optional<StraightSide> side = straight_side(walk, scale_);
    if (!side || (chains_.chains[chain].stepped && !is_level(*side))) return std::nullopt;
    return Arm{chain, walk, *side};
  }

  std::vector<Corner> at_nodes() const;
  std::vector<Corner> inside(std::size_t chain) const;
  std::optional<Corner> guess_inside(std::size_t chain, std::size_t point) const;

  std::size_t place(std::vector<Corner> corners);
  bool is_free(const Corner& corner) const;
  void place(const Corner& corner);

  const image::Image& image_;
  double scale_;  // pixels of the chains per pixel of the picture
  FeatureChains& chains_;
  const CornerOptions& options_;
  KnownCorners::Fans* known_;
  std::vector<std::vector<bool>> taken_;  // by chain and point: a corner has moved it
};

/// Nodes where three or more chains meet, all of them straight near by.
std::vector<Corner> Sharpener::at_nodes() const {
  struct End {
    std::size_t chain;
    bool forward;
  };
  std::vector<std::vector<End>> ends(chains_.node_count);
  for (std::size_t c = 0; c < chains_.chains.size(); ++c) {
    const Chain& chain = chains_.chains[c];
    if (chain.closed) continue;
    ends[chain.first_node].push_back({c, true});
    ends[chain.last_node].push_back({c, false});
  }
  std::vector<Corner> corners;
  for (const std::vector<End>& node : ends) {
    if (node.size() < 3) continue;
    Corner corner;
    for (const End& end : node) {
      const Chain& chain = chains_.chains[end.chain];
      const std::size_t from = end.forward ? 0 : chain.points.size() - 1;
      corner.found = chain.points[from].position;
      if (std::optional<Arm> a = arm(end.chain, from, end.forward)) corner.arms.push_back(*a);
    }
    if (corner.arms.size() == node.size() && guess_position(scale_, corner) &&
        find_position(image_, scale_, options_.most_error, known_, corner))
      corners.push_back(std::move(corner));
  }
  return corners;
}

std::vector<Corner> Sharpener::inside(std::size_t c) const {
  const Chain& chain = chains_.chains[c];
  std::vector<Corner> guesses;
  // From point to point directions are rough.
  const double bend = std::cos(0.7 * radians(options_.least_turn));
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    if (straightness(chain, i) > bend) continue;
    if (std::optional<Corner> guess = guess_inside(c, i)) guesses.push_back(std::move(*guess));
  }
  keep_nearest(scale_, guesses);
  std::erase_if(guesses, [&](Corner& guess) {
    return !find_position(image_, scale_, options_.most_error, known_, guess);
  });
  return guesses;
}

std::optional<Corner> Sharpener::guess_inside(std::size_t c, std::size_t point) const {
  const std::optional<Arm> back = arm(c, point, false);
  const std::optional<Arm> on = arm(c, point, true);
  if (!back || !on) return std::nullopt;
  const double turn =
      std::numbers::pi - std::acos(std::clamp(dot(back->side.away, on->side.away), -1.0, 1.0));
  const double arc = std::min(turn_of_arc(back->side, on->side, scale_), kNoArc);
  if (turn < std::max(radians(options_.least_turn), arc)) return std::nullopt;
  Corner corner{on->walk.at(0), {*back, *on}, {}, 0};
  if (!guess_position(scale_, corner)) return std::nullopt;
  return corner;
}

/// The best first, as long as they do not move points of others.
std::size_t Sharpener::place(std::vector<Corner> corners) {
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.error < b.error; });
  std::size_t count = 0;
  for (const Corner& corner : corners) {
    if (!is_free(corner)) continue;
    place(corner);
    ++count;
  }
  return count;
}

bool Sharpener::is_free(const Corner& corner) const {
  return std::all_of(corner.arms.begin(), corner.arms.end(), [&](const Arm& arm) {
    for (std::size_t k = 0; k < arm.side.gap; ++k) {
      if (taken_[arm.chain][arm.walk.index(k)]) return false;
    }
    return true;
  });
}

/// Spreads the points before the straight sides evenly over the lines to the corner.
void Sharpener::place(const Corner& corner) {
  for (const Arm& arm : corner.arms) {
    Chain& chain = chains_.chains[arm.chain];
    const Vec2 first = arm.walk.at(arm.side.gap);
    const Vec2 on_line = dot(first - corner.position, arm.side.away) * arm.side.away;
    for (std::size_t k = 0; k < arm.side.gap; ++k) {
      const std::size_t i = arm.walk.index(k);
      chain.points[i].move_to(corner.position + (double(k) / double(arm.side.gap)) * on_line);
      taken_[arm.chain][i] = true;
    }
    chain.points[arm.walk.index(0)].corner = true;
  }
}

}  // namespace

std::size_t sharpen_corners(const image::Image& image, FeatureChains& chains, const CornerOptions& options,
                            KnownCorners* known) {
  if (!(options.least_turn >= 0 && options.least_turn <= 180))
    throw Error(ErrorKind::kInvalidArgument, "the least turn of a corner must be in 0..180 degrees");
  if (!(options.most_error > 0))
    throw Error(ErrorKind::kInvalidArgument, "the error of a corner must be positive");
  if (known) known->fans().begin_picture();
  return Sharpener(image, chains, options, known ? &known->fans() : nullptr).run();
}

}  // namespace knotreel::features
