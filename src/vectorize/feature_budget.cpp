// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/feature_budget.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "knotreel/features/scale.h"

namespace knotreel::vectorize {

namespace {

// Weak ones are those of little worth within three pixels that have more contrast farther away, which are
// soft edges. If they have to go, features are left with this share of the control points at most.
constexpr double kLeftToWeak = 0.075;
constexpr double kWeakWorth = 140;  // levels
constexpr double kSharpness = 0.93;
// Of a share, when it is exceeded: estimates by pixels are rough, and another try costs a parametrization.
constexpr double kMargin = 0.75;
// Most that is left then: where features are so many, most are text or texture, and what is between them
// needs the control points more.
constexpr double kMostLeft = 0.3;
// Curves cost the more control points the more they turn: those of a radius of 17 px or more as many as
// straight ones, a letter's, of some 5 px, twice as many, about. Radians per pixel, and the inverse of them.
constexpr double kFreeTurning = 0.06;
constexpr double kTurnsAreDear = 8;
constexpr std::size_t kStep = 4;  // points, between which the direction of a chain is taken

std::size_t chain_pixels(const features::FeatureChains& chains) {
  std::size_t pixels = 0;
  for (const features::Chain& c : chains.chains) pixels += c.points.size();
  return pixels;
}

/// Radians per pixel.
double turning(const features::Chain& chain) {
  double sum = 0;
  Vec2 before{};
  for (std::size_t i = 0; i + kStep < chain.points.size(); i += kStep) {
    const Vec2 step = chain.points[i + kStep].position - chain.points[i].position;
    const double lengths = norm(before) * norm(step);
    if (lengths > 0) sum += std::acos(std::clamp(dot(before, step) / lengths, -1.0, 1.0));
    before = step;
  }
  return sum / static_cast<double>(chain.points.size());
}

struct RankedChain {
  double contrast = 0;  ///< levels
  double worth = 0;     ///< the same, for what straight ones cost
  bool weak = false;
  features::Chain chain;
};

RankedChain ranked(const image::Image& picture, int scale, features::Chain chain) {
  const double contrast = mean_range(picture, chain, 1, scale);
  const bool sharp = contrast >= kSharpness * mean_range(picture, chain, 3, scale);
  const double worth = contrast / (1 + kTurnsAreDear * std::max(0.0, scale * turning(chain) - kFreeTurning));
  return {contrast, worth, worth < kWeakWorth && !sharp, std::move(chain)};
}

/// Drops the chains that are worth least, or the weak ones among them, until at most this share of the
/// feature pixels is left. What a chain costs grows with its length, as does what it is good for, but the
/// latter with its contrast too; and text and texture, which turn all the time, cost more per pixel than
/// outlines.
DroppedFeatures keep_strongest(const image::Image& picture, double share, bool weak_only,
                               features::FeatureChains& chains) {
  const double allowed = share * static_cast<double>(chain_pixels(chains));
  const int scale = features::scale_of(chains, picture);
  std::vector<RankedChain> all;
  for (features::Chain& c : chains.chains) all.push_back(ranked(picture, scale, std::move(c)));
  std::stable_sort(all.begin(), all.end(),
                   [](const RankedChain& a, const RankedChain& b) { return a.worth > b.worth; });
  std::size_t kept = 0;
  DroppedFeatures dropped;
  chains.chains.clear();
  for (RankedChain& r : all) {
    const std::size_t length = r.chain.points.size();
    if ((r.weak || !weak_only) && static_cast<double>(kept + length) > allowed) {
      dropped.add({!weak_only, static_cast<double>(length), r.contrast * static_cast<double>(length)});
      continue;
    }
    kept += length;
    chains.chains.push_back(std::move(r.chain));
  }
  return dropped;
}

}  // namespace

double mean_range(const image::Image& picture, const features::Chain& chain, int radius, int scale) {
  double sum = 0;
  for (const features::ChainPoint& p : chain.points) {
    const int px = p.x / scale;
    const int py = p.y / scale;
    float range = 0;
    for (int c = 0; c < picture.channels; ++c) {
      float low = picture.at(px, py, c);
      float high = low;
      for (int y = std::max(0, py - radius); y <= std::min(picture.height - 1, py + radius); ++y) {
        for (int x = std::max(0, px - radius); x <= std::min(picture.width - 1, px + radius); ++x) {
          low = std::min(low, picture.at(x, y, c));
          high = std::max(high, picture.at(x, y, c));
        }
      }
      range = std::max(range, high - low);
    }
    sum += static_cast<double>(range);
  }
  return sum / static_cast<double>(chain.points.size());
}

double expected_functions(const mesh::EditableMesh& mesh, int degree) {
  std::size_t inner = 0;
  std::size_t fixed = 0;
  for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.is_face(f)) continue;
    for (int i = 0; i < 3; ++i) ++(mesh.is_fixed({f, i}) ? fixed : inner);
  }
  // Inner edges are met twice, those of features too, which is how often they count once cut open.
  const double edges = 0.855 * static_cast<double>(inner) / 2 + static_cast<double>(fixed);
  return degree == 1 ? edges / 2.5 : degree == 2 ? edges : 1.6 * edges;
}

double expected_functions(const features::FeatureChains& chains) {
  return kFunctionsPerFeaturePixel * static_cast<double>(chain_pixels(chains));
}

features::FeatureChains drop_winding(double max_turning, features::FeatureChains& chains) {
  features::FeatureChains dropped{chains.width, chains.height, {}, chains.node_count};
  std::vector<features::Chain>& all = chains.chains;
  const auto first = std::stable_partition(
      all.begin(), all.end(), [&](const features::Chain& c) { return !(turning(c) > max_turning); });
  dropped.chains.assign(std::make_move_iterator(first), std::make_move_iterator(all.end()));
  all.erase(first, all.end());
  return dropped;
}

void DroppedFeatures::add(const DroppedFeatures& more) {
  strong = strong || more.strong;
  points += more.points;
  contrast += more.contrast;
}

DroppedFeatures keep_within_budget(const image::Image& picture, double functions, double most,
                                   const FeatureShares& shares, features::FeatureChains& chains) {
  if (functions <= shares.weak * most) return {};
  const double left_to_weak = std::min(kMargin * shares.weak, kLeftToWeak) * most / functions;
  const DroppedFeatures dropped = keep_strongest(picture, left_to_weak, true, chains);
  if (dropped.points > 0 || functions <= shares.any * most) return dropped;
  return keep_strongest(picture, std::min(kMargin * shares.any, kMostLeft) * most / functions, false, chains);
}

}  // namespace knotreel::vectorize
