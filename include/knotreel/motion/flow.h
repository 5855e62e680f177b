// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"
#include "knotreel/motion/luma.h"

/// What moves where between two pictures. Points and pixels are those of knotreel/base/vec2.h: the centre of
/// pixel (i, j) is at (i + 0.5, j + 0.5).
namespace knotreel::motion {

/// A displacement in pixels for every pixel of a picture: what is seen at p there is at p + flow(p) in the
/// other picture.
struct Flow {
  int width = 0;
  int height = 0;
  std::vector<float> xy;  ///< row-major; dx, dy of one pixel after those of the other

  /// Displacement at any finite point, bilinear between pixel centres; beyond the outermost centres it is
  /// that of the nearest place within. The flow must not be empty.
  Vec2 at(Vec2 p) const;
};

struct FlowOptions {
  /// With the median error where a smooth texture shifts or turns, in pixels.
  enum class Effort {
    kUltrafast,  ///< patches only, on a quarter of the size; 0.1 to 0.2
    kFast,       ///< and a variational refinement there: twice the time; 0.1
    kMedium,     ///< on half of the size, denser patches: five times the time of kFast; 0.02 to 0.06
  };
  Effort effort = Effort::kFast;
  /// Of pairs: the way back is only searched with kUltrafast, and turn_round() makes it as exact as the way
  /// there: half of the time.
  bool turn_back = false;
};

/// Where every pixel of `from` has gone in `to`: dense inverse search [Kroeger16] on the luma.
/// Sensible up to displacements of about an eighth of the smaller side; flat places follow what is around.
/// Both pictures have the same size; any size will do (below 32 pixels they are continued by their border).
/// @throws Error{kInvalidArgument} if the sizes differ or a picture is empty.
/// May use all threads; the result does not depend on their number. May be called from several at once.
Flow find_flow(const Luma& from, const Luma& to, const FlowOptions& options = {});
Flow find_flow(const image::Image& from, const image::Image& to, const FlowOptions& options = {});

inline constexpr double kLeastTolerance = 1.0;  ///< pixels
inline constexpr double kToleranceShare = 0.05;

/// Which pixels of `forward` are found again: there and back, |forward + backward(there)| is at most
/// least + share * |forward| (pixels). What leaves the picture, or is hidden in the other one, is not.
/// @param backward flow from the other picture to that of `forward`, of the same size.
/// @return 1 or 0 per pixel, row-major.
/// @throws Error{kInvalidArgument} if the sizes differ.
/// All threads are used; the result does not depend on their number.
std::vector<std::uint8_t> consistent(const Flow& forward, const Flow& backward,
                                     double least = kLeastTolerance, double share = kToleranceShare);

/// Makes a roughly known flow as exact as the one from the other picture: vectors that are found again become
/// the opposite of the vector where they lead.
/// @return which are found again: as consistent() of the rough flow, before, with its default tolerances.
/// @throws Error{kInvalidArgument} if the sizes differ.
/// All threads are used; the result does not depend on their number.
std::vector<std::uint8_t> turn_round(const Flow& exact, Flow& rough);

/// Flow there and back, and which pixels are found again.
struct FlowPair {
  Flow forward;
  Flow backward;
  std::vector<std::uint8_t> consistent;       ///< of the first picture
  std::vector<std::uint8_t> consistent_back;  ///< of the second one
};

/// All of it at once, in less than the time of its parts: both directions run at the same time.
/// @throws as find_flow().
FlowPair find_flow_pair(const Luma& from, const Luma& to, const FlowOptions& options = {});

/// The same for pictures of which parts are equal: looked for around what has changed only, and elsewhere
/// nothing moves. Where next to all has changed, as find_flow_pair() above.
/// @param unchanged of unchanged_cells() for the two pictures.
/// @throws Error{kInvalidArgument} if sizes differ.
FlowPair find_flow_pair(const Luma& from, const Luma& to, std::span<const std::uint8_t> unchanged,
                        const FlowOptions& options = {});

/// Largest distance in pixels, along either axis, at which point_motion() looks for pixels to learn from.
inline constexpr int kMotionReach = 32;

/// Displacements of points of the picture of `forward`. In a consistent pixel: the flow, bilinear between the
/// consistent ones of the four pixels around. Elsewhere: the median (of x and of y) of the consistent flow
/// vectors in a window around, which doubles until there are a few of them; zero if there are none within
/// kMotionReach.
/// @param points finite; points outside the picture have the motion of the nearest place within.
/// @param consistent as from consistent().
/// @throws Error{kInvalidArgument} if `consistent` has not one value per pixel of a flow that is not empty.
/// All threads are used; the result does not depend on their number.
std::vector<Vec2> point_motion(std::span<const Vec2> points, const Flow& forward,
                               const std::vector<std::uint8_t>& consistent);

}  // namespace knotreel::motion
