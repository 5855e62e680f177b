// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/hidden_colours.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::image {
namespace {

constexpr float kNothing = 0.5F;  // levels of alpha
constexpr float kFaint = 16;      // likewise; a colour that was stored times alpha is off by up to 8 there
constexpr float kWhole = 0.5F;    // share of a block that has to be seen for its mean to count whole

/// Premultiplied by the weight, and the weight, per pixel.
struct Level {
  Level(int w, int h, int colour_count)
      : width(w), height(h), colours(colour_count), v(std::size_t(w) * std::size_t(h) * stride()) {}
  std::size_t stride() const { return std::size_t(colours) + 1; }
  float* at(int x, int y) {
    return v.data() + (std::size_t(y) * std::size_t(width) + std::size_t(x)) * stride();
  }
  const float* at(int x, int y) const { return const_cast<Level*>(this)->at(x, y); }

  int width;
  int height;
  int colours;
  std::vector<float> v;
};

/// 1 for hidden pixels.
std::vector<std::uint8_t> hidden_pixels(const Image& picture) {
  const int alpha = picture.channels - 1;
  const auto is_seen_beside = [&](int x, int y) {
    for (int j = std::max(0, y - 1); j <= std::min(picture.height - 1, y + 1); ++j) {
      for (int i = std::max(0, x - 1); i <= std::min(picture.width - 1, x + 1); ++i) {
        if (picture.at(i, j, alpha) >= kFaint) return true;
      }
    }
    return false;
  };
  std::vector<std::uint8_t> hidden(picture.pixel_count());
  parallel_for(std::size_t(picture.height), [&](std::size_t row) {
    const int y = int(row);
    for (int x = 0; x < picture.width; ++x) {
      const float a = picture.at(x, y, alpha);
      const bool is = a < kNothing || (a < kFaint && is_seen_beside(x, y));
      hidden[row * std::size_t(picture.width) + std::size_t(x)] = is ? 1 : 0;
    }
  });
  return hidden;
}

Level seen_colours(const Image& picture, const std::vector<std::uint8_t>& hidden) {
  Level level(picture.width, picture.height, picture.colour_channels());
  parallel_for(std::size_t(picture.height), [&](std::size_t y) {
    for (int x = 0; x < picture.width; ++x) {
      if (hidden[y * std::size_t(picture.width) + std::size_t(x)] != 0) continue;
      float* to = level.at(x, int(y));
      for (int c = 0; c < level.colours; ++c) to[c] = picture.at(x, int(y), c);
      to[level.colours] = 1;
    }
  });
  return level;
}

/// Of half the size: means of blocks of 2x2.
Level halved(const Level& fine) {
  Level coarse((fine.width + 1) / 2, (fine.height + 1) / 2, fine.colours);
  parallel_for(std::size_t(coarse.height), [&](std::size_t row) {
    const int y = int(row);
    for (int x = 0; x < coarse.width; ++x) {
      float* to = coarse.at(x, y);
      float count = 0;
      for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j) {
        for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i, ++count) {
          for (std::size_t c = 0; c < fine.stride(); ++c) to[c] += fine.at(i, j)[c];
        }
      }
      const float sum = to[fine.colours];
      if (sum == 0) continue;
      const float weight = std::min(1.0F, sum / (kWhole * count));
      for (std::size_t c = 0; c < fine.stride(); ++c) to[c] *= weight / sum;
    }
  });
  return coarse;
}

/// The two pixels of a line of half the size that one is between; the second has a quarter of the weight.
struct Between {
  int first, second;
};
constexpr float kSecond = 0.25F;

Between between(int fine, int coarse_size) {
  const int near = fine / 2;
  return {near, std::clamp(fine % 2 == 0 ? near - 1 : near + 1, 0, coarse_size - 1)};
}

/// What is missing to a weight of 1 comes from the coarser level, linearly in between.
void fill(const Level& coarse, Level& fine) {
  parallel_for(std::size_t(fine.height), [&](std::size_t row) {
    const Between down = between(int(row), coarse.height);
    for (int x = 0; x < fine.width; ++x) {
      float* to = fine.at(x, int(row));
      const float missing = 1 - to[fine.colours];
      if (missing <= 0) continue;
      const Between right = between(x, coarse.width);
      const auto along = [&](int y, std::size_t c) {
        return (1 - kSecond) * coarse.at(right.first, y)[c] + kSecond * coarse.at(right.second, y)[c];
      };
      for (std::size_t c = 0; c < fine.stride(); ++c)
        to[c] += missing * ((1 - kSecond) * along(down.first, c) + kSecond * along(down.second, c));
    }
  });
}

}  // namespace

Image extend_seen_colours(Image picture) {
  if (!picture.has_alpha()) return picture;
  const std::vector<std::uint8_t> hidden = hidden_pixels(picture);
  if (std::ranges::find(hidden, 1) == hidden.end()) return picture;
  std::vector<Level> levels;
  levels.push_back(seen_colours(picture, hidden));
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(halved(levels.back()));
  for (std::size_t k = levels.size() - 1; k-- > 0;) fill(levels[k + 1], levels[k]);
  const Level& filled = levels.front();
  parallel_for(std::size_t(picture.height), [&](std::size_t y) {
    for (int x = 0; x < picture.width; ++x) {
      if (hidden[y * std::size_t(picture.width) + std::size_t(x)] == 0) continue;
      const float* from = filled.at(x, int(y));
      const float weight = from[filled.colours];
      for (int c = 0; c < filled.colours; ++c) picture.at(x, int(y), c) = weight > 0 ? from[c] / weight : 0;
    }
  });
  return picture;
}

}  // namespace knotreel::image
