// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "document/control_coding.h"

/// Colours of control points (docs/format.md, "Control points" and "Colours of other frames").
namespace knotreel::document {

/// 0: as before, then by eighths of the larger one: octaves; new functions have a class of their own.
inline std::size_t area_change_class(std::int64_t area, std::int64_t before) {
  if (area == before) return 0;
  const std::int64_t larger = std::max({std::int64_t{1}, area, before});
  const auto part = static_cast<std::uint64_t>(128 * std::abs(area - before) / larger);
  return std::min<std::size_t>(ChangingColourModels::kChanges - 2,
                               1 + static_cast<std::size_t>(std::bit_width(part)));
}

template <class Coder>
class ColourCoding {
 public:
  /// @param before  null for a keyframe.
  ColourCoding(Coder& coder, ControlModels& models, FrameState& state, const FrameState* before,
               const Matches& matches, std::size_t channels)
      : coder_(coder),
        models_(models),
        state_(state),
        before_(before),
        matches_(matches),
        channels_(channels),
        degree_(static_cast<std::size_t>(state.space->degree())),
        coded_(state.space->cut().corners.size()) {}

  void run() {
    state_.history.areas = polygon_areas(*state_.space, state_.grid);
    state_.history.changes.assign(state_.colour.size(), 0);
    for (spline::FunctionIndex f = 0; f < state_.space->function_count(); ++f) code(f);
  }

 private:
  using Vector = Neighbourhood<4>::Vector;

  /// A function, and what is known of it before its next channel is coded.
  struct Context {
    spline::FunctionIndex function;
    bool old;                 ///< there is the same function before
    std::uint32_t match;      ///< which
    std::size_t area;         ///< class of its polygon
    std::size_t change;       ///< class of the change of that
    std::int64_t first = 0;   ///< difference of the channel coded first, 0 for itself
    std::int64_t second = 0;  ///< of the one after that, 0 for both
  };

  Context context(spline::FunctionIndex f) const {
    const std::int64_t area = state_.history.areas[f];
    const bool old = before_ && matches_.functions[f] != kNoMatch;
    if (!old) return {f, false, 0, area_class(area), ChangingColourModels::kChanges - 1};
    const std::uint32_t match = matches_.functions[f];
    return {f, true, match, area_class(area), area_change_class(area, before_->history.areas[match])};
  }

  std::span<const mesh::CornerIndex> places(spline::FunctionIndex f) const {
    return std::span(state_.space->functions()[f].knots).first(degree_);
  }

  void code(spline::FunctionIndex f) {
    Context known = context(f);
    Vector prediction = coded_.mean(places(f));
    if (known.old) {
      const auto was = std::span(before_->colour).subspan(channels_ * known.match, channels_);
      std::copy(was.begin(), was.end(), prediction.begin());
    }
    // Green goes first where there is one; its error is a good guess of that of red and blue.
    const bool coloured = channels_ >= 3;
    const std::array<std::size_t, 4> order{coloured ? 1u : 0u, coloured ? 0u : 1u, 2, 3};
    Vector difference{};
    for (std::size_t i = 0; i < channels_; ++i) {
      const std::size_t c = order[i];
      const bool guessed = coloured && i > 0 && c < 3;
      if (guessed) prediction[c] += difference[1] * state_.colour_unit;
      difference[c] = code(known, c, prediction[c]);
      if (i == 0) known.first = difference[c];
      if (i == 1) known.second = difference[c];
    }
    if (known.old) remember(f, difference);
    const auto colour = std::span(state_.colour).subspan(channels_ * f, channels_);
    Vector value{};
    std::copy(colour.begin(), colour.end(), value.begin());
    coded_.add(places(f), value, difference);
  }

  /// @return the difference of a channel.
  std::int64_t code(const Context& known, std::size_t c, std::int64_t prediction) {
    const Around around = coded_.around(places(known.function), c);
    const auto units = [&](std::int64_t& value, std::int64_t expected) {
      ResidualModels& alone = models_.colour[known.old ? 1 : 0][c];
      return before_ ? code_mixed(known, c, alone, around, value, expected)
                     : code_residual(coder_, alone, around, value, expected);
    };
    return code_control(units, state_.colour_unit, state_.colour[channels_ * known.function + c], prediction);
  }

  std::int64_t code_mixed(const Context& known, std::size_t c, ResidualModels& alone, const Around& around,
                          std::int64_t& value, std::int64_t expected) {
    ChangingColourModels& models = models_.changing[known.old ? 1 : 0][c];
    const std::int64_t last = known.old ? before_->history.changes[channels_ * known.match + c] : 0;
    const MixedNumber<3> magnitude(
        alone.magnitude[expected_size(around)],
        {&models.earlier[small_class(known.first) * kSmallClasses + small_class(known.second)],
         &models.shape[known.change * kAreaClasses + known.area],
         &models.history[known.area * kSmallClasses + small_class(last)]},
        models.magnitude);
    MixedBit<4> negative(
        {&alone.negative[sign_class(around.sum)],
         &models.earlier_sign[3 * sign_class(known.first) + sign_class(known.second)],
         &models.last_sign[signed_class(last)], &models.nearby_sign[signed_class(around.twice_mean())]},
        models.sign);
    return code_difference(coder_, magnitude, negative, value, expected);
  }

  void remember(spline::FunctionIndex f, const Vector& difference) {
    constexpr std::int64_t kMost = 100;
    for (std::size_t c = 0; c < channels_; ++c) {
      state_.history.changes[channels_ * f + c] =
          static_cast<std::int8_t>(std::clamp(difference[c], -kMost, kMost));
    }
  }

  Coder& coder_;
  ControlModels& models_;
  FrameState& state_;
  const FrameState* before_;
  const Matches& matches_;
  std::size_t channels_;
  std::size_t degree_;
  Neighbourhood<4> coded_;
};

}  // namespace knotreel::document
