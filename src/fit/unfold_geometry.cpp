#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::fit {

namespace {

using spline::Basis;
using spline::BasisJet;

// The map may shrink areas to this share; below that it counts as about to fold.
constexpr double kLeastArea = 0.05;
constexpr double kShrink = 0.85;  // of displacements at folds, each time
constexpr int kMaxRounds = 24;
constexpr double kAlong = 0.75;                     // pixels between samples along a feature
constexpr double kAcross[] = {0.0, 0.7, 1.5, 3.0};  // pixels from the feature

/// Points on both sides of the features, where the map bends most, with the side to look at them from.
struct Sample {
  Vec2 u;
  Vec2 direction;
};

std::vector<Sample> feature_samples(const mesh::KnotMesh& mesh) {
  std::vector<Sample> samples;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 b = mesh.knots[s.knots.back()].position;
    const double length = norm(b - a);
    const Vec2 normal = (1 / length) * Vec2{a.y - b.y, b.x - a.x};
    const int count = std::max(2, static_cast<int>(std::ceil(length / kAlong)));
    for (int i = 0; i < count; ++i) {
      const Vec2 p = a + ((i + 0.5) / count) * (b - a);
      for (const double side : {-1.0, 1.0}) {
        for (const double distance : kAcross) {
          const Vec2 u = p + (side * distance) * normal;
          if (u.x < 0 || u.y < 0 || u.x > mesh.width || u.y > mesh.height) break;
          samples.push_back({u, side * normal});
        }
      }
    }
  }
  return samples;
}

}  // namespace

std::size_t unfold_geometry(const Basis& basis, std::vector<Vec2>& displacement) {
  const auto& space = basis.space();
  const std::vector<Sample> samples = feature_samples(space.mesh());
  std::vector<std::vector<BasisJet>> jets(samples.size());
  parallel_for(samples.size(),
               [&](std::size_t i) { basis.evaluate(samples[i].u, samples[i].direction, jets[i]); });
  std::vector<std::uint8_t> shrink(displacement.size());
  std::size_t folds = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::fill(shrink.begin(), shrink.end(), std::uint8_t{0});
    folds = 0;
    for (const auto& values : jets) {
      Vec2 by_x{1, 0};
      Vec2 by_y{0, 1};
      for (const BasisJet& j : values) {
        const Vec2 d = displacement[space.geometry_of()[j.function]];
        by_x = by_x + j.jet.dx * d;
        by_y = by_y + j.jet.dy * d;
      }
      if (cross(by_x, by_y) >= kLeastArea) continue;
      ++folds;
      for (const BasisJet& j : values) shrink[space.geometry_of()[j.function]] = 1;
    }
    if (folds == 0) break;
    for (std::size_t g = 0; g < displacement.size(); ++g) {
      if (shrink[g]) displacement[g] = kShrink * displacement[g];
    }
  }
  return folds;
}

}  // namespace knotreel::fit
