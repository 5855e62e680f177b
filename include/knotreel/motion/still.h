// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/motion/luma.h"

namespace knotreel::motion {

/// When a place counts as still although the flow moves it.
struct StillOptions {
  int radius = 4;      ///< of the window, in pixels: (2 radius + 1)^2 of them, fewer at the border
  double ratio = 1.2;  ///< standing still may leave so many times the mean squared residual of moving ...
  double slack = 6.0;  ///< ... and so much more, in squared levels
};

/// What the pictures say of a place that the flow moves.
enum class Stillness : std::uint8_t {
  kMoves,   ///< moving explains the next picture better than staying
  kStays,   ///< no motion at all, or staying explains it about as well ...
  kEither,  ///< ... and so does moving: there is next to nothing to be seen
};

/// The dead zone of motion: tells places that had better stay where they are, since moving them hardly
/// explains the next picture better. Residuals are those of luma, smoothed by (1 2 1)/4 along both axes so
/// that noise does not count as motion. Costs two passes over the pictures once and the same few operations
/// for any point.
class StillTest {
 public:
  /// @param from, to pictures of one size. @param moved the second seen from the place of the first: warp()
  /// along the flow.
  /// @throws Error{kInvalidArgument} if sizes differ, a picture is empty or the radius is negative.
  StillTest(const Luma& from, const Luma& to, const Luma& moved, const StillOptions& options = {});

  /// Whether the pictures around a point are explained about as well by no motion as by the flow, and whether
  /// the flow explains them about as well as no motion.
  /// @param p finite; outside the picture the nearest pixel counts. Thread safe.
  Stillness at(Vec2 p) const;

 private:
  StillOptions options_;
  int width_;
  int height_;
  std::vector<std::uint64_t> standing_;  // sums over all pixels above and left, (width + 1) x (height + 1)
  std::vector<std::uint64_t> moving_;
};

/// Of every point: kStays if it has no motion at all, else what StillTest says.
/// @param motions displacements of the points, as from point_motion().
/// @throws Error{kInvalidArgument} as StillTest, or if points and motions differ in number.
std::vector<Stillness> still_points(std::span<const Vec2> points, std::span<const Vec2> motions,
                                    const Luma& from, const Luma& to, const Luma& moved,
                                    const StillOptions& options = {});

}  // namespace knotreel::motion
