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

struct PositionModels {
  std::array<ResidualModels, 2> border;  ///< new, old
  std::array<ResidualModels, 2> vertex;
  std::array<ResidualModels, 2> parameter;
  std::array<std::array<ResidualModels, 2>, 2> free;  ///< by x and y
};

struct ControlModels {
  std::array<std::array<ResidualModels, 2>, 2> displacement;  ///< by new and old, x and y
  std::array<std::array<ResidualModels, 4>, 2> colour;        ///< by new and old, channel
};

struct FrameModels {
  TopologyModels topology;
  LinkModels links;
  PositionModels positions;
  ControlModels controls;
};

}  // namespace knotreel::document
