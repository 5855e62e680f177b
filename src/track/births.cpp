// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/births.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include "knotreel/features/fair.h"
#include "knotreel/fit/geometry_fit.h"
#include "vectorize/feature_budget.h"

namespace knotreel::track {

namespace {

using features::Chain;
using features::ChainPoint;

constexpr double kCurveSpacing = 1.5;    // of points on feature curves, pixels
constexpr double kMostCrowded = 0.25;    // of a curve that has another one beside it
constexpr std::size_t kRingOpening = 6;  // points left out of a closed chain, whose ends must not touch

/// Pixels that are near a curve.
class Taken {
 public:
  Taken(int width, int height, double reach)
      : width_(width), height_(height), reach_(reach), taken_(std::size_t(width) * std::size_t(height), 0) {}

  void add(Vec2 p) {
    const int x0 = std::max(0, static_cast<int>(std::floor(p.x - reach_)));
    const int x1 = std::min(width_ - 1, static_cast<int>(std::floor(p.x + reach_)));
    const int y0 = std::max(0, static_cast<int>(std::floor(p.y - reach_)));
    const int y1 = std::min(height_ - 1, static_cast<int>(std::floor(p.y + reach_)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        if (norm(Vec2{x + 0.5, y + 0.5} - p) < reach_) taken_[at(x, y)] = 1;
      }
    }
  }

  bool has(const ChainPoint& p) const {
    const bool inside = p.position.x >= reach_ && p.position.y >= reach_ && p.position.x <= width_ - reach_ &&
                        p.position.y <= height_ - reach_;
    return !inside || taken_[at(p.x, p.y)];
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }

  int width_;
  int height_;
  double reach_;
  std::vector<std::uint8_t> taken_;
};

/// Runs of a chain off what is taken, as open chains of at least so many points.
std::vector<Chain> free_runs(const Chain& chain, const Taken& taken, double least) {
  std::vector<Chain> runs;
  Chain run;
  const auto close = [&] {
    if (static_cast<double>(run.points.size()) >= least) runs.push_back(run);
    run.points.clear();
  };
  // A ring begins behind what is taken, so that no run is cut in two where its points begin.
  std::size_t first = 0;
  if (chain.closed) {
    while (first < chain.points.size() && !taken.has(chain.points[first])) ++first;
  }
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const ChainPoint& p = chain.points[(first + i) % chain.points.size()];
    if (taken.has(p)) {
      close();
    } else {
      run.points.push_back(p);
    }
  }
  if (chain.closed && run.points.size() == chain.points.size()) {
    run.points.resize(run.points.size() - std::min(run.points.size(), kRingOpening));
  }
  close();
  return runs;
}

/// Mean over the pixels on a chain and next to it.
double mean_beside(std::span<const float> values, int width, const Chain& chain) {
  double sum = 0;
  for (const ChainPoint& p : chain.points) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {  // inside: chains are off the sides here
        sum +=
            static_cast<double>(values[std::size_t(p.y + dy) * std::size_t(width) + std::size_t(p.x + dx)]);
      }
    }
  }
  return sum / (9 * static_cast<double>(chain.points.size()));
}

double length_of(const std::vector<Vec2>& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += norm(line[i] - line[i - 1]);
  return length;
}

/// The point between two others that is farthest from the line through them, if it is farther than allowed.
std::optional<std::size_t> farthest_between(const Chain& chain, std::size_t first, std::size_t last,
                                            double allowed) {
  const Vec2 a = chain.points[first].position;
  const Vec2 along = chain.points[last].position - a;
  const double length = norm(along);
  std::optional<std::size_t> farthest;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vec2 d = chain.points[i].position - a;
    const double away = length > 0 ? std::abs(along.x * d.y - along.y * d.x) / length : norm(d);
    if (away <= allowed) continue;
    allowed = away;
    farthest = i;
  }
  return farthest;
}

/// The points of a chain that a polyline needs to stay near all of them (Douglas-Peucker).
std::vector<Vec2> polyline_of(const Chain& chain, double distance) {
  std::vector<bool> vertex(chain.points.size(), false);
  vertex.front() = vertex.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, chain.points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    const std::optional<std::size_t> split = farthest_between(chain, first, last, distance);
    if (!split) continue;
    vertex[*split] = true;
    open.emplace_back(first, *split);
    open.emplace_back(*split, last);
  }
  std::vector<Vec2> line;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    if (vertex[i]) line.push_back(chain.points[i].position);
  }
  return line;
}

/// Points of the feature curves of a surface in the image.
std::vector<Vec2> curve_points(const spline::Basis& basis, std::span<const Vec2> displacement) {
  const mesh::KnotMesh& mesh = basis.space().mesh();
  std::vector<Vec2> points;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 from = mesh.knots[s.knots.front()].position;
    const Vec2 along = mesh.knots[s.knots.back()].position - from;
    const int n = std::max(1, static_cast<int>(std::lround(norm(along) / kCurveSpacing)));
    for (int i = 0; i <= n; ++i) points.push_back(from + (static_cast<double>(i) / n) * along);
  }
  return fit::image_points(basis, displacement, std::move(points));
}

/// Where the points of all chains are.
class ChainMap {
 public:
  explicit ChainMap(const features::FeatureChains& chains)
      : width_(chains.width), height_(chains.height), at_(std::size_t(width_) * std::size_t(height_)) {
    for (std::size_t c = 0; c < chains.chains.size(); ++c) {
      const std::vector<ChainPoint>& points = chains.chains[c].points;
      ring_.push_back(chains.chains[c].closed ? points.size() : 0);
      for (std::size_t i = 0; i < points.size(); ++i) place(points[i].x, points[i].y) = {c + 1, i};
    }
  }

  /// Share of the points of a run of chain c that have another chain, or another part of the same, within
  /// reach.
  double share_beside_others(std::size_t c, const Chain& run, int reach) const {
    const auto crowded = [&](const ChainPoint& p) {
      const Mark& own = place(p.x, p.y);
      for (int y = std::max(0, p.y - reach); y <= std::min(height_ - 1, p.y + reach); ++y) {
        for (int x = std::max(0, p.x - reach); x <= std::min(width_ - 1, p.x + reach); ++x) {
          const Mark& m = place(x, y);
          if (m.chain != 0 && (m.chain != c + 1 || apart(c, m.index, own.index) > std::size_t(4 * reach)))
            return true;
        }
      }
      return false;
    };
    return static_cast<double>(std::count_if(run.points.begin(), run.points.end(), crowded)) /
           static_cast<double>(run.points.size());
  }

 private:
  struct Mark {
    std::size_t chain = 0;  ///< plus one; 0: none
    std::size_t index = 0;  ///< in the chain
  };

  /// Points from one to another of a chain, the shorter way if it is a ring.
  std::size_t apart(std::size_t chain, std::size_t a, std::size_t b) const {
    const std::size_t between = a > b ? a - b : b - a;
    return ring_[chain] > 0 ? std::min(between, ring_[chain] - between) : between;
  }

  Mark& place(int x, int y) { return at_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }
  const Mark& place(int x, int y) const { return at_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }

  int width_;
  int height_;
  std::vector<Mark> at_;
  std::vector<std::size_t> ring_;  ///< points of each chain that is one, else 0
};

struct MissedChain {
  double error;
  Chain chain;
};

/// Parts of the chains that are off what is taken, strong enough, and missed; most missed ones first.
std::vector<MissedChain> missed_chains(const features::FeatureChains& chains, const Taken& taken,
                                       const image::Image& picture, std::span<const float> squared_errors,
                                       const BirthOptions& options) {
  const double mean = std::accumulate(squared_errors.begin(), squared_errors.end(), 0.0) /
                      static_cast<double>(squared_errors.size());
  std::vector<MissedChain> missed;
  const ChainMap map(chains);
  for (std::size_t c = 0; c < chains.chains.size(); ++c) {
    for (Chain& run : free_runs(chains.chains[c], taken, options.min_length)) {
      const double error = mean_beside(squared_errors, picture.width, run);
      if (error < options.error * mean || vectorize::mean_range(picture, run, 1) < options.contrast) continue;
      if (map.share_beside_others(c, run, options.apart) > kMostCrowded) continue;
      missed.push_back({error, std::move(run)});
    }
  }
  std::stable_sort(missed.begin(), missed.end(),
                   [](const MissedChain& a, const MissedChain& b) { return a.error > b.error; });
  return missed;
}

/// Where a point of the image is in the domain, to a fraction of a pixel.
Vec2 place_of(const PlacedPixels& seen, Vec2 p) {
  const std::span<const Vec2> places = seen.placed->places();
  if (places.empty()) return p;
  const int x = std::clamp(static_cast<int>(p.x), 0, seen.picture.width - 1);
  const int y = std::clamp(static_cast<int>(p.y), 0, seen.picture.height - 1);
  const std::size_t i = std::size_t(y) * std::size_t(seen.picture.width) + std::size_t(x);
  return p + (places[i] - Vec2{x + 0.5, y + 0.5});
}

}  // namespace

double feature_length(const mesh::KnotMesh& mesh) {
  double length = 0;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    length += norm(mesh.knots[s.knots.back()].position - mesh.knots[s.knots.front()].position);
  }
  return length;
}

std::vector<std::vector<Vec2>> missing_features(const spline::Basis& basis,
                                                std::span<const Vec2> displacement, const PlacedPixels& seen,
                                                const image::Image& picture,
                                                std::span<const float> squared_errors,
                                                const features::DetectOptions& detect, double most_length,
                                                const BirthOptions& options) {
  std::vector<std::vector<Vec2>> lines;
  if (most_length < options.min_length) return lines;
  features::DetectOptions strict = detect;
  strict.edge_threshold *= options.strength;
  strict.anchor_threshold *= options.strength;
  strict.min_weight *= options.strength;
  features::FeatureChains chains = features::detect_features(picture, strict);
  features::fair_chains(chains);
  Taken taken(picture.width, picture.height, options.reach);
  for (const Vec2 p : curve_points(basis, displacement)) taken.add(p);
  for (const MissedChain& missed : missed_chains(chains, taken, picture, squared_errors, options)) {
    for (const Chain& run : free_runs(missed.chain, taken, options.min_length)) {  // off those chosen before
      std::vector<Vec2> line = polyline_of(run, options.polyline_distance);
      const double length = length_of(line);
      if (length > most_length) continue;
      most_length -= length;
      for (const ChainPoint& p : run.points) taken.add(p.position);
      for (Vec2& p : line) p = place_of(seen, p);
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

}  // namespace knotreel::track
