// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/chains.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

namespace knotreel::testing {

using features::Chain;
using features::ChainPoint;
using features::NodeIndex;

namespace {

Vec2 clamped(Vec2 p, const ChainPoint& at) {
  return {std::clamp(p.x, at.x - 0.5, at.x + 1.5), std::clamp(p.y, at.y - 0.5, at.y + 1.5)};
}

/// Laplacian smoothing of paper Eq. 5 with lambda = 0.5, five times; ends stay.
void fair(Chain& chain) {
  const auto n = static_cast<int>(chain.points.size());
  for (int round = 0; round < 5; ++round) {
    std::vector<Vec2> p;
    for (const ChainPoint& c : chain.points) p.push_back(c.position);
    const auto at = [&](int i) {
      return p[static_cast<std::size_t>(chain.closed ? (i + n) % n : std::clamp(i, 0, n - 1))];
    };
    for (int i = chain.closed ? 0 : 1; i < (chain.closed ? n : n - 1); ++i) {
      ChainPoint& c = chain.points[static_cast<std::size_t>(i)];
      c.position = clamped(0.5 * at(i) + 0.125 * (at(i - 2) + at(i - 1) + at(i + 1) + at(i + 2)), c);
    }
  }
}

}  // namespace

ChainBuilder::ChainBuilder(int width, int height)
    : taken_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), false) {
  chains.width = width;
  chains.height = height;
}

bool ChainBuilder::is_free(int x, int y) const {
  for (int ny = std::max(0, y - 1); ny <= std::min(chains.height - 1, y + 1); ++ny) {
    for (int nx = std::max(0, x - 1); nx <= std::min(chains.width - 1, x + 1); ++nx) {
      if (taken_[static_cast<std::size_t>(ny * chains.width + nx)]) return false;
    }
  }
  return true;
}

std::vector<ChainBuilder::Pixel> ChainBuilder::draw(const std::vector<Vec2>& curve, bool closed) const {
  std::vector<Pixel> pixels;
  const auto near = [](Pixel a, Pixel b) { return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) <= 1; };
  const auto push_pixel = [&](Pixel p) {
    if (!pixels.empty() && pixels.back().x == p.x && pixels.back().y == p.y) return;
    // Corners of the staircase are cut: only consecutive pixels are neighbours.
    while (pixels.size() >= 2 && near(pixels[pixels.size() - 2], p)) pixels.pop_back();
    pixels.push_back(p);
  };
  const std::size_t pieces = closed ? curve.size() : curve.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const Vec2 a = curve[i];
    const Vec2 b = curve[(i + 1) % curve.size()];
    const int steps = 1 + static_cast<int>(20 * norm(b - a));
    for (int s = 0; s <= steps; ++s) {
      const Vec2 p = a + (static_cast<double>(s) / steps) * (b - a);
      const Pixel pixel{static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y))};
      const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < chains.width && pixel.y < chains.height;
      if (!inside) return closed ? std::vector<Pixel>{} : pixels;
      // A curve that comes back to itself ends there.
      for (std::size_t k = 0; !closed && k + 6 < pixels.size(); ++k) {
        if (near(pixels[k], pixel)) return pixels;
      }
      push_pixel(pixel);
    }
  }
  while (closed && pixels.size() > 3 && near(pixels[pixels.size() - 2], pixels.front())) pixels.pop_back();
  while (closed && pixels.size() > 3 && near(pixels.back(), pixels[1])) pixels.erase(pixels.begin());
  return pixels;
}

void ChainBuilder::push(const std::vector<Pixel>& pixels, bool closed, NodeIndex first, NodeIndex last) {
  Chain chain;
  chain.closed = closed;
  chain.first_node = first;
  chain.last_node = last;
  for (const Pixel p : pixels) {
    taken_[static_cast<std::size_t>(p.y * chains.width + p.x)] = true;
    chain.points.push_back({p.x, p.y, {p.x + 0.5, p.y + 0.5}});
  }
  fair(chain);
  const auto at_border = [&](Pixel p) {
    return p.x == 0 || p.y == 0 || p.x + 1 == chains.width || p.y + 1 == chains.height;
  };
  chain.first_on_border = !closed && at_border(pixels.front());
  chain.last_on_border = !closed && at_border(pixels.back());
  chains.chains.push_back(std::move(chain));
}

bool ChainBuilder::add(const std::vector<Vec2>& curve, bool closed, std::size_t least) {
  std::vector<Pixel> pixels = draw(curve, closed);
  const auto blocked =
      std::find_if(pixels.begin(), pixels.end(), [&](Pixel p) { return !is_free(p.x, p.y); });
  if (closed) {
    if (pixels.size() < 8 || blocked != pixels.end()) return false;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      for (std::size_t k = i + 2; k + (i == 0 ? 1 : 0) < pixels.size(); ++k) {
        if (std::abs(pixels[i].x - pixels[k].x) <= 1 && std::abs(pixels[i].y - pixels[k].y) <= 1)
          return false;
      }
    }
    push(pixels, true, 0, 0);
    return true;
  }
  pixels.erase(blocked, pixels.end());
  if (pixels.size() < std::max<std::size_t>(least, 2)) return false;
  push(pixels, false, chains.node_count, chains.node_count + 1);
  chains.node_count += 2;
  return true;
}

bool ChainBuilder::add_star(Vec2 centre, const std::vector<std::vector<Vec2>>& arms) {
  std::vector<std::vector<Pixel>> drawn;
  for (const auto& arm : arms) {
    drawn.push_back(draw(arm, false));
    if (drawn.back().size() < 4) return false;
    for (const Pixel p : drawn.back()) {
      if (!is_free(p.x, p.y)) return false;
    }
  }
  // Pixels of two arms are neighbours within two steps of the node only.
  for (std::size_t a = 0; a < drawn.size(); ++a) {
    for (std::size_t b = a + 1; b < drawn.size(); ++b) {
      for (std::size_t i = 1; i < drawn[a].size(); ++i) {
        for (std::size_t k = 1; k < drawn[b].size(); ++k) {
          const int distance =
              std::max(std::abs(drawn[a][i].x - drawn[b][k].x), std::abs(drawn[a][i].y - drawn[b][k].y));
          if (distance == 0 || (distance == 1 && (i > 2 || k > 2))) return false;
        }
      }
    }
  }
  const NodeIndex node = chains.node_count++;
  (void)centre;
  for (const auto& pixels : drawn) push(pixels, false, node, chains.node_count++);
  return true;
}

std::vector<Vec2> arc(Vec2 centre, double radius, double from, double to) {
  std::vector<Vec2> points;
  const int n = 8 + static_cast<int>(radius * std::abs(to - from));
  for (int i = 0; i < n; ++i) {
    const double a = from + (to - from) * i / n;
    points.push_back(centre + radius * Vec2{std::cos(a), std::sin(a)});
  }
  return points;
}

features::FeatureChains random_chains(int width, int height, int count, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  ChainBuilder b(width, height);
  const auto point = [&] { return Vec2{uniform(0, width), uniform(0, height)}; };
  const auto wander = [&](Vec2 p, double angle, int steps, double bend) {
    std::vector<Vec2> curve{p};
    double turn = 0;
    for (int i = 0; i < steps; ++i) {
      turn = 0.8 * turn + uniform(-bend, bend);
      angle += turn;
      p = p + 3.0 * Vec2{std::cos(angle), std::sin(angle)};
      curve.push_back(p);
    }
    return curve;
  };
  for (int i = 0; i < count; ++i) {
    const Vec2 p = point();
    const double angle = uniform(0, 6.28);
    switch (std::uniform_int_distribution<int>(0, 6)(random)) {
      case 0:
        b.add(arc(p, uniform(3, 30)), true);
        break;
      case 1: {  // parallel lines, two pixels apart or a little more
        const double gap = uniform(2, 4);
        const Vec2 normal{-std::sin(angle), std::cos(angle)};
        const std::vector<Vec2> line = wander(p, angle, 15, 0.02);
        for (int k = 0; k < 3; ++k) {
          std::vector<Vec2> moved;
          for (const Vec2 q : line) moved.push_back(q + (k * gap) * normal);
          b.add(moved, false, 4);
        }
        break;
      }
      case 2: {
        std::vector<std::vector<Vec2>> arms;
        const int n = std::uniform_int_distribution<int>(3, 5)(random);
        for (int k = 0; k < n; ++k) arms.push_back(wander(p, angle + 6.28 * k / n, 8, 0.05));
        b.add_star(p, arms);
        break;
      }
      case 3: {  // spiral
        std::vector<Vec2> curve;
        for (double a = 0; a < 15; a += 0.1) {
          curve.push_back(p + (2 + 0.6 * a) * Vec2{std::cos(a + angle), std::sin(a + angle)});
        }
        b.add(curve, false, 4);
        break;
      }
      default:
        b.add(wander(p, angle, 30, 0.15), false, 3);
    }
  }
  return b.chains;
}

features::FeatureChains mirrored(const features::FeatureChains& chains) {
  features::FeatureChains out = chains;
  for (Chain& chain : out.chains) {
    for (ChainPoint& p : chain.points) {
      p.x = chains.width - 1 - p.x;
      p.position.x = chains.width - p.position.x;
    }
  }
  return out;
}

}  // namespace knotreel::testing
