// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

/// Pictures for tests of features, and questions about chains.
namespace knotreel::features::testing {

/// Antialiased by the mean of 8 x 8 samples per pixel.
inline image::Image draw(int width, int height, const std::function<double(double, double)>& value) {
  constexpr int kSamples = 8;
  image::Image image = image::make_image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) sum += value(x + (i + 0.5) / kSamples, y + (j + 0.5) / kSamples);
      }
      image.at(x, y, 0) = float(sum / (kSamples * kSamples));
    }
  }
  return image;
}

inline image::Image disc(int size, double centre_x, double centre_y, double radius, double in = 200,
                         double out = 50) {
  return draw(size, size,
              [=](double x, double y) { return std::hypot(x - centre_x, y - centre_y) < radius ? in : out; });
}

/// A polygon that is convex, corners in either order.
inline image::Image convex_polygon(int width, int height, const std::vector<Vec2>& corners) {
  return draw(width, height, [&](double x, double y) {
    int left = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec2 next = corners[(i + 1) % corners.size()];
      left += cross(next - corners[i], Vec2{x, y} - corners[i]) > 0 ? 1 : 0;
    }
    return left == 0 || left == int(corners.size()) ? 220.0 : 30.0;
  });
}

enum class Turn { kMirrorX, kMirrorY, kTranspose };

inline image::Image turned(const image::Image& image, Turn turn) {
  const bool transpose = turn == Turn::kTranspose;
  image::Image result = image::make_image(transpose ? image.height : image.width,
                                          transpose ? image.width : image.height, image.channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int to_x = transpose ? y : turn == Turn::kMirrorX ? image.width - 1 - x : x;
      const int to_y = transpose ? x : turn == Turn::kMirrorY ? image.height - 1 - y : y;
      for (int c = 0; c < image.channels; ++c) result.at(to_x, to_y, c) = image.at(x, y, c);
    }
  }
  return result;
}

inline std::set<std::pair<int, int>> pixels_of(const FeatureChains& chains) {
  std::set<std::pair<int, int>> pixels;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint& p : chain.points) pixels.insert({p.x, p.y});
  }
  return pixels;
}

inline std::size_t point_count(const FeatureChains& chains) {
  std::size_t count = 0;
  for (const Chain& chain : chains.chains) count += chain.points.size();
  return count;
}

/// How many chains end at each node.
inline std::map<NodeIndex, int> arms_of_nodes(const FeatureChains& chains) {
  std::map<NodeIndex, int> arms;
  for (const Chain& chain : chains.chains) {
    if (chain.closed) continue;
    ++arms[chain.first_node];
    ++arms[chain.last_node];
  }
  return arms;
}

/// A chain through pixels, at their centres.
inline Chain chain_through(std::initializer_list<std::pair<int, int>> pixels, NodeIndex first,
                           NodeIndex last) {
  Chain chain;
  for (const auto& [x, y] : pixels) chain.points.push_back({x, y, {x + 0.5, y + 0.5}});
  chain.first_node = first;
  chain.last_node = last;
  return chain;
}

/// A closed chain along the sides of a square.
inline Chain square_chain(int left, int top, int size) {
  Chain chain;
  chain.closed = true;
  const auto add = [&](int x, int y) { chain.points.push_back({x, y, {x + 0.5, y + 0.5}}); };
  for (int k = 1; k < size - 1; ++k) add(left + k, top);
  for (int k = 1; k < size - 1; ++k) add(left + size - 1, top + k);
  for (int k = size - 2; k > 0; --k) add(left + k, top + size - 1);
  for (int k = size - 2; k > 0; --k) add(left, top + k);
  return chain;
}

}  // namespace knotreel::features::testing
