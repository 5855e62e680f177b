// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/refine_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

constexpr int kSide = 8;             // of the window, pixels
constexpr double kHalf = kSide / 2;  // its corner is so far from the point
constexpr int kStride = 16;          // of rows of pixels that are read at once, of which up to 11 are used

/// One pixel more on all sides than the window, for differences.
constexpr int kFramed = kSide + 2;

template <int Rows>
using PixelRows = std::array<std::array<float, kStride>, std::size_t{Rows}>;
template <int Side>
using Samples = std::array<std::array<float, std::size_t{Side}>, std::size_t{Side}>;
using Window = Samples<kSide>;

/// Pixels from column x and row y on; beside the picture, the nearest ones.
template <int Rows>
[[gnu::always_inline]] inline void read_pixels(const Luma& luma, int x, int y, PixelRows<Rows>& out) {
  const bool inside = x >= 0 && y >= 0 && x + kStride <= luma.width && y + Rows <= luma.height;
  for (int j = 0; j < Rows; ++j) {
    const int row = inside ? y + j : std::clamp(y + j, 0, luma.height - 1);
    const std::uint8_t* const from = luma.v.data() + std::size_t(row) * std::size_t(luma.width);
    float* const to = out[std::size_t(j)].data();
    if (inside) {
      for (int i = 0; i < kStride; ++i) to[i] = float(from[x + i]);
    } else {
      for (int i = 0; i < kStride; ++i) to[i] = float(from[std::clamp(x + i, 0, luma.width - 1)]);
    }
  }
}

/// Side x Side samples a pixel apart, bilinear, the first of them at a corner (pixel centres at +0.5).
template <int Side>
[[gnu::always_inline]] inline void read_samples(const Luma& luma, double left, double top,
                                                Samples<Side>& out) {
  const double x = std::floor(left - 0.5);
  const double y = std::floor(top - 0.5);
  PixelRows<Side + 1> pixels;
  read_pixels<Side + 1>(luma, int(x), int(y), pixels);
  const auto fx = float(left - 0.5 - x);
  const auto fy = float(top - 0.5 - y);
  for (std::size_t j = 0; j < std::size_t{Side}; ++j) {
    for (std::size_t i = 0; i < std::size_t{Side}; ++i) {
      const float upper = pixels[j][i] + fx * (pixels[j][i + 1] - pixels[j][i]);
      const float lower = pixels[j + 1][i] + fx * (pixels[j + 1][i + 1] - pixels[j + 1][i]);
      out[j][i] = upper + fy * (lower - upper);
    }
  }
}

/// Column by column first, so that the width of vectors makes no difference.
struct LaneSums {
  std::array<float, kSide> lanes{};

  [[gnu::always_inline]] double total() const {
    double sum = 0;
    for (const float l : lanes) sum += double{l};
    return sum;
  }
};

/// What is seen around a point, and how it changes along either axis.
struct Patch {
  Window value;
  Window by_x;
  Window by_y;
  double xx = 0;  ///< sums of products of the changes
  double xy = 0;
  double yy = 0;
};

[[gnu::always_inline]] inline void read_patch(const Luma& luma, Vec2 p, Patch& patch) {
  Samples<kFramed> framed;
  read_samples<kFramed>(luma, p.x - kHalf - 0.5, p.y - kHalf - 0.5, framed);
  LaneSums xx, xy, yy;
  for (std::size_t j = 0; j < std::size_t{kSide}; ++j) {
    for (std::size_t i = 0; i < std::size_t{kSide}; ++i) {
      const float x = 0.5F * (framed[j + 1][i + 2] - framed[j + 1][i]);
      const float y = 0.5F * (framed[j + 2][i + 1] - framed[j][i + 1]);
      patch.value[j][i] = framed[j + 1][i + 1];
      patch.by_x[j][i] = x;
      patch.by_y[j][i] = y;
      xx.lanes[i] += x * x;
      xy.lanes[i] += x * y;
      yy.lanes[i] += y * y;
    }
  }
  patch.xx = xx.total();
  patch.xy = xy.total();
  patch.yy = yy.total();
}

struct Mismatch {
  double squared = 0;  ///< sum over the window of the difference less its mean
  Vec2 by_place;       ///< half of how it changes along either axis
};

[[gnu::always_inline]] inline Mismatch miss_at(const Luma& luma, Vec2 p, const Patch& patch) {
  Window seen;
  read_samples<kSide>(luma, p.x - kHalf + 0.5, p.y - kHalf + 0.5, seen);
  LaneSums sum;
  for (std::size_t j = 0; j < std::size_t{kSide}; ++j) {
    for (std::size_t i = 0; i < std::size_t{kSide}; ++i) {
      seen[j][i] -= patch.value[j][i];
      sum.lanes[i] += seen[j][i];
    }
  }
  const auto mean = float(sum.total() / (kSide * kSide));
  LaneSums squared, x, y;
  for (std::size_t j = 0; j < std::size_t{kSide}; ++j) {
    for (std::size_t i = 0; i < std::size_t{kSide}; ++i) {
      const float d = seen[j][i] - mean;
      squared.lanes[i] += d * d;
      x.lanes[i] += d * patch.by_x[j][i];
      y.lanes[i] += d * patch.by_y[j][i];
    }
  }
  return {squared.total(), {x.total(), y.total()}};
}

/// Steps of Gauss and Newton while the miss becomes less. The changes are those of the picture that the point
/// is in, which stay the same.
/// @param miss_of of a place in the other picture.
template <class MissOf>
[[gnu::always_inline]] inline Vec2 search(Vec2 p, Vec2 motion, double xx, double xy, double yy,
                                          const RefineMotionOptions& options, const MissOf& miss_of) {
  const double slack = options.stiffness * kSide * kSide;
  xx += slack;
  yy += slack;
  const double determinant = xx * yy - xy * xy;
  Vec2 found = motion;
  Mismatch miss = miss_of(p + found);
  for (int step = 0; step < options.steps; ++step) {
    const Vec2 g = miss.by_place + slack * (found - motion);
    const Vec2 next = found - Vec2{(yy * g.x - xy * g.y) / determinant, (xx * g.y - xy * g.x) / determinant};
    if (norm(next - motion) > options.most) break;
    const Mismatch there = miss_of(p + next);
    if (!(there.squared < miss.squared)) break;
    found = next;
    miss = there;
  }
  return found;
}

KNOTREEL_MULTIVERSION
Vec2 refined(Vec2 p, Vec2 motion, const Luma& from, const Luma& to, const RefineMotionOptions& options) {
  Patch patch;
  read_patch(from, p, patch);
  return search(p, motion, patch.xx, patch.xy, patch.yy, options,
                [&](Vec2 place) { return miss_at(to, place, patch); });
}

double sample(const Luma& luma, Vec2 p) {
  const auto at = [&](double x, double y) {
    const auto inside = [](double v, int count) {
      return std::size_t(std::clamp(v, 0.0, double(count - 1)));
    };
    return double(luma.v[inside(y, luma.height) * std::size_t(luma.width) + inside(x, luma.width)]);
  };
  const double x = std::floor(p.x - 0.5);
  const double y = std::floor(p.y - 0.5);
  const double fx = p.x - 0.5 - x;
  const double fy = p.y - 0.5 - y;
  return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) +
         fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
}

}  // namespace

void refine_motion(std::span<const Vec2> points, std::span<Vec2> motions, const Luma& from, const Luma& to,
                   const RefineMotionOptions& options) {
  check_sizes(from, to);
  if (points.size() != motions.size())
    throw Error(ErrorKind::kInvalidArgument, "points and motions differ in number");
  constexpr std::size_t kBlock = 64;
  parallel_for((points.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(points.size(), (block + 1) * kBlock); ++i) {
      if (motions[i] != Vec2{}) motions[i] = refined(points[i], motions[i], from, to, options);
    }
  });
}

Vec2 refined_motion_reference(Vec2 p, Vec2 motion, const Luma& from, const Luma& to,
                              const RefineMotionOptions& options) {
  struct Pixel {
    Vec2 offset;
    double value;
    Vec2 change;
  };
  std::vector<Pixel> window;
  double xx = 0, xy = 0, yy = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Vec2 offset{i + 0.5 - kHalf, j + 0.5 - kHalf};
      const auto difference = [&](Vec2 step) {
        return 0.5 * (sample(from, p + offset + step) - sample(from, p + offset - step));
      };
      window.push_back({offset, sample(from, p + offset), {difference({1, 0}), difference({0, 1})}});
      const Vec2 change = window.back().change;
      xx += change.x * change.x;
      xy += change.x * change.y;
      yy += change.y * change.y;
    }
  }
  return search(p, motion, xx, xy, yy, options, [&](Vec2 place) {
    double mean = 0;
    for (const Pixel& w : window) mean += (sample(to, place + w.offset) - w.value) / double(window.size());
    Mismatch miss;
    for (const Pixel& w : window) {
      const double d = sample(to, place + w.offset) - w.value - mean;
      miss.squared += d * d;
      miss.by_place = miss.by_place + d * w.change;
    }
    return miss;
  });
}

}  // namespace knotreel::motion
