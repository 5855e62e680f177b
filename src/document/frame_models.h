// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "document/number_coding.h"

/// What a coder has learnt about the frames of a group so far (docs/format.md, "Models"). A keyframe begins
/// anew, so that decoding can begin there.
namespace knotreel::document {

struct TopologyModels {
  SignedModel side_count;
  NumberModel fresh_count;
  BitModel border_follows;
  BitModel border_fresh;
  SignedModel border_reference;
  SignedModel keyframe_id;
  SignedModel fresh_id;
  std::array<BitModel, 2> alive;  ///< of knots that are not free, and free ones

  using Recent = std::array<BitModel, 4>;  ///< by what the last two faces were: as expected or not
  std::array<Recent, 5> expected;          ///< by Expectation
  struct StepModels {
    BitModel found;
    BitModel right;
    BitModel left;
  };
  std::array<std::array<StepModels, 16>, 5> step;  ///< by Expectation and the last two steps
  NumberModel split;
  std::array<BitModel, 5> fresh;
  NumberModel candidate;
  SignedModel reference;

  BitModel segment_alive;
  NumberModel segment_count;
  NumberModel segment_first;
  NumberModel segment_next;
};

struct LinkModels {
  static constexpr std::size_t kSpans = 8;               ///< longer spans count as the longest
  std::array<std::array<BitModel, 2>, kSpans> expected;  ///< by span and whether the last one was expected
  std::array<std::array<NumberModel, 2>, kSpans> code;   ///< by span and whether there was an expectation
};

/// Differences from predictions: their size has a model for every size that those around make one expect.
struct ResidualModels {
  static constexpr std::size_t kSizes = 14;
  std::array<NumberModel, kSizes> magnitude;
  std::array<BitModel, 3> negative;  ///< by the sign of those around: none or mixed, positive, negative
};

inline constexpr std::size_t kSmallClasses = 7;  ///< of magnitudes, where few classes do
inline constexpr std::size_t kAreaClasses = 12;  ///< of triangles and polygons

/// Whether a free knot has stayed in its place (docs/format.md, "Free knots of other frames").
struct StayModels {
  std::array<BitModel, 8 * 16> around;   ///< by its last three frames, and how many around are old and moved
  std::array<BitModel, 16 * 4> history;  ///< by its last four frames, and whether it was expected to move
  std::array<BitModel, kSmallClasses * kSmallClasses * 4> expected;  ///< by the move expected of it
  Mixer<3> mixer;
};

/// One coordinate of a free knot of a frame that is no keyframe, mixed with its ResidualModels.
struct MovingKnotModels {
  std::array<ShortNumberModel, kSmallClasses * ResidualModels::kSizes> beside;  ///< by its other coordinate
  std::array<ShortNumberModel, 16 * kSmallClasses> around;  ///< by how many around are old and moved
  std::array<ShortNumberModel, kAreaClasses * ResidualModels::kSizes> area;  ///< by the triangle expected
  std::array<ShortNumberModel, kSmallClasses * kSmallClasses> expected;      ///< by the move expected of it
  NumberMixer<5> magnitude;
  std::array<BitModel, 3 * kSmallClasses> along;   ///< signs by the move expected
  std::array<BitModel, 3 * kSmallClasses> nearby;  ///< signs by the mean of those around
  Mixer<3> sign;
};

struct PositionModels {
  std::array<ResidualModels, 2> border;  ///< new, old
  std::array<ResidualModels, 2> vertex;
  std::array<ResidualModels, 2> parameter;
  std::array<std::array<ResidualModels, 2>, 2> free;  ///< by x and y
  StayModels stays;
  std::array<std::array<MovingKnotModels, 2>, 2> moving;  ///< new, old; by x and y
};

/// A channel of a control colour of a frame that is no keyframe, mixed with its ResidualModels
/// (docs/format.md, "Colours of other frames").
struct ChangingColourModels {
  static constexpr std::size_t kChanges = 9;                            ///< of an area since the frame before
  std::array<ShortNumberModel, kSmallClasses * kSmallClasses> earlier;  ///< by the channels before
  std::array<ShortNumberModel, kChanges * kAreaClasses> shape;          ///< by the polygon and its change
  std::array<ShortNumberModel, kAreaClasses * kSmallClasses> history;  ///< by the polygon and the last change
  NumberMixer<4> magnitude;
  std::array<BitModel, 9> earlier_sign;                 ///< by those of the channels before
  std::array<BitModel, 3 * kSmallClasses> last_sign;    ///< by the last change
  std::array<BitModel, 3 * kSmallClasses> nearby_sign;  ///< by the mean of those around
  Mixer<4> sign;
};

struct ControlModels {
  std::array<std::array<ResidualModels, 2>, 2> displacement;    ///< by new and old, x and y
  std::array<std::array<ResidualModels, 4>, 2> colour;          ///< by new and old, channel
  std::array<std::array<ChangingColourModels, 4>, 2> changing;  ///< the same
};

struct FrameModels {
  TopologyModels topology;
  LinkModels links;
  PositionModels positions;
  ControlModels controls;
};

}  // namespace knotreel::document
