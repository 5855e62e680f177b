// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/sharpen_edges.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace knotreel::fit {

namespace {

struct Place {
  int x;
  int y;
};

/// Pixels that are not crossed, but next to one that is.
std::vector<Place> places_beside(std::span<const std::uint8_t> crossed, int width, int height) {
  const auto is_crossed = [&](int x, int y) {
    return crossed[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)] != 0;
  };
  std::vector<std::uint8_t> found(crossed.size(), 0);
  std::vector<Place> places;
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    if (!crossed[i]) continue;
    const int x = static_cast<int>(i % static_cast<std::size_t>(width));
    const int y = static_cast<int>(i / static_cast<std::size_t>(width));
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
        std::uint8_t& is_found = found[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                       static_cast<std::size_t>(u)];
        if (is_found || is_crossed(u, v)) continue;
        is_found = 1;
        places.push_back({u, v});
      }
    }
  }
  return places;
}

/// Whether a pixel and its neighbours have colours that are seen; the others mean nothing.
bool is_opaque_around(const image::Image& picture, Place place) {
  if (!picture.has_alpha()) return true;
  for (int v = std::max(0, place.y - 1); v <= std::min(picture.height - 1, place.y + 1); ++v) {
    for (int u = std::max(0, place.x - 1); u <= std::min(picture.width - 1, place.x + 1); ++u) {
      if (picture.at(u, v, picture.channels - 1) < 255) return false;
    }
  }
  return true;
}

}  // namespace

void sharpen_edges(image::Image& picture, std::span<const std::uint8_t> crossed, double softness) {
  if (!(softness > 0)) return;
  const auto s = static_cast<float>(softness);
  const auto clamped = [](int v, int size) { return std::clamp(v, 0, size - 1); };
  const auto filtered = [&](int x, int y, int channel) {
    const auto row = [&](int v) {
      const int at = clamped(v, picture.height);
      return s * (picture.at(clamped(x - 1, picture.width), at, channel) +
                  picture.at(clamped(x + 1, picture.width), at, channel)) +
             (1 - 2 * s) * picture.at(x, at, channel);
    };
    return s * (row(y - 1) + row(y + 1)) + (1 - 2 * s) * row(y);
  };
  const std::vector<Place> places = places_beside(crossed, picture.width, picture.height);
  std::vector<float> gains;
  for (const Place& p : places) {
    const int first = is_opaque_around(picture, p) ? 0 : picture.colour_channels();  // else alpha alone
    gains.insert(gains.end(), static_cast<std::size_t>(first), 0.0F);
    for (int c = first; c < picture.channels; ++c)
      gains.push_back(picture.at(p.x, p.y, c) - filtered(p.x, p.y, c));
  }
  auto gain = gains.begin();
  for (const Place& p : places) {
    for (int c = 0; c < picture.channels; ++c) picture.at(p.x, p.y, c) += *gain++;
  }
}

}  // namespace knotreel::fit
