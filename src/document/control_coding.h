#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "document/frame_state.h"
#include "document/identity.h"
#include "document/residual_coding.h"

/// Control points as differences from predictions (docs/format.md, "Control points").
namespace knotreel::document {

/// What has been coded so far of the basis functions that share a corner or knot with the next one.
/// @tparam Size  length of the vectors.
template <std::size_t Size>
class Neighbourhood {
 public:
  using Vector = std::array<std::int64_t, Size>;

  explicit Neighbourhood(std::size_t place_count) : places_(place_count) {}

  /// The mean of the vectors, to the nearest, halves up; the last vector if there are none.
  Vector mean(std::span<const std::uint32_t> places) const {
    Vector sum{};
    std::int64_t count = 0;
    for (const std::uint32_t p : places) {
      for (std::size_t i = 0; i < Size; ++i) sum[i] += places_[p].sum[i];
      count += places_[p].count;
    }
    if (count == 0) return last_;
    for (std::int64_t& s : sum) s = floor_div(2 * s + count, 2 * count);
    return sum;
  }

  /// Differences of component i from their predictions.
  Around around(std::span<const std::uint32_t> places, std::size_t i) const {
    Around result;
    for (const std::uint32_t p : places) result.add(places_[p].differences[i]);
    return result;
  }

  void add(std::span<const std::uint32_t> places, const Vector& value, const Vector& differences) {
    for (const std::uint32_t p : places) {
      for (std::size_t i = 0; i < Size; ++i) {
        places_[p].sum[i] += value[i];
        places_[p].differences[i].add(differences[i]);
      }
      ++places_[p].count;
    }
    last_ = value;
  }

 private:
  struct Place {
    Vector sum{};
    std::int64_t count = 0;
    std::array<Around, Size> differences{};
  };

  std::vector<Place> places_;
  Vector last_{};
};

/// Codes a value that is a multiple of `unit`; so is the prediction then, rounded to the nearest, halves up.
/// @param code  codes units, given a prediction. @return the difference in units.
template <class Code>
std::int64_t code_control(const Code& code, std::int64_t unit, std::int64_t& value, std::int64_t prediction) {
  std::int64_t units = value / unit;
  const std::int64_t difference = code(units, floor_div(2 * prediction + unit, 2 * unit));
  value = units * unit;
  if (value < -kMaxControl || value > kMaxControl) malformed("a control point is out of range");
  return difference;
}

/// What the size of a change of colour is told from, but for those around.
struct ColourContext {
  std::int64_t first = 0;   ///< difference of the channel coded first, 0 for itself
  std::int64_t second = 0;  ///< of the one after that
  std::int64_t last = 0;    ///< of this channel in the frame before
  std::size_t area = 0;     ///< class of the function's polygon
  std::size_t change = 0;   ///< class of the change of its area
};

/// 0: as before, then by eighths of the larger one: octaves, the last for new functions.
inline std::size_t change_class(std::int64_t area, std::int64_t before) {
  if (area == before) return 0;
  const std::int64_t larger = std::max({std::int64_t{1}, area, before});
  const auto part = static_cast<std::uint64_t>(128 * std::abs(area - before) / larger);
  return std::min<std::size_t>(ChangingColourModels::kChanges - 2,
                               1 + static_cast<std::size_t>(std::bit_width(part)));
}

template <class Coder>
std::int64_t code_change(Coder& coder, ChangingColourModels& models, ResidualModels& alone,
                         const Around& around, const ColourContext& context, std::int64_t& value,
                         std::int64_t prediction) {
  const std::size_t first = small_class(context.first);
  MixedNumber<3> magnitude(alone.magnitude[expected_size(around)],
                           {&models.earlier[first * kSmallClasses + small_class(context.second)],
                            &models.shape[context.change * kAreaClasses + context.area],
                            &models.history[context.area * kSmallClasses + small_class(context.last)]},
                           models.magnitude);
  const auto negative = [&] {
    return MixedBit<4>({&alone.negative[sign_class(around.sum)],
                        &models.earlier_sign[3 * sign_class(context.first) + sign_class(context.second)],
                        &models.last_sign[signed_class(context.last)],
                        &models.nearby_sign[signed_class(around.twice_mean())]},
                       models.sign);
  };
  return code_difference(coder, magnitude, negative(), value, prediction);
}

/// @param before  null for a keyframe.
template <class Coder>
void code_displacements(Coder& coder, ControlModels& models, FrameState& state, const FrameState* before,
                        const Matches& matches) {
  const spline::SplineSpace& space = *state.space;
  std::vector<spline::FunctionIndex> first(space.geometry_count(), spline::kNoFunction);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    spline::FunctionIndex& any = first[space.geometry_of()[f]];
    if (any == spline::kNoFunction) any = f;
  }
  const auto degree = static_cast<std::size_t>(space.degree());
  Neighbourhood<2> coded(space.mesh().knots.size());
  for (std::uint32_t g = 0; g < space.geometry_count(); ++g) {
    std::array<std::uint32_t, spline::kMaxDegree> knots{};
    for (std::size_t i = 0; i < degree; ++i) {
      knots[i] = space.cut().corners[space.functions()[first[g]].knots[i]].knot;
    }
    const auto places = std::span(knots).first(degree);
    const bool old = before && matches.groups[g] != kNoMatch;
    const auto prediction = old ? std::array{before->displacement[2 * matches.groups[g]],
                                             before->displacement[2 * matches.groups[g] + 1]}
                                : coded.mean(places);
    std::array<std::int64_t, 2> difference{};
    for (std::size_t i = 0; i < 2; ++i) {
      std::int64_t& value = state.displacement[2 * g + i];
      const auto code = [&](std::int64_t& units, std::int64_t guess) {
        return code_residual(coder, models.displacement[old ? 1 : 0][i], coded.around(places, i), units,
                             guess);
      };
      difference[i] = code_control(code, 1, value, prediction[i]);
    }
    coded.add(places, {state.displacement[2 * g], state.displacement[2 * g + 1]}, difference);
  }
}

/// @param before  null for a keyframe.
template <class Coder>
void code_colours(Coder& coder, ControlModels& models, FrameState& state, const FrameState* before,
                  const Matches& matches, std::size_t channels) {
  const spline::SplineSpace& space = *state.space;
  const auto degree = static_cast<std::size_t>(space.degree());
  Neighbourhood<4> coded(space.cut().corners.size());
  FrameHistory& history = state.history;
  history.areas = polygon_areas(space, state.grid);
  history.changes.assign(state.colour.size(), 0);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const auto places = std::span(space.functions()[f].knots).first(degree);
    const bool old = before && matches.functions[f] != kNoMatch;
    const std::uint32_t match = old ? matches.functions[f] : 0;
    auto prediction = coded.mean(places);
    if (old) {
      const auto was = std::span(before->colour).subspan(channels * match, channels);
      std::copy(was.begin(), was.end(), prediction.begin());
    }
    const auto colour = std::span(state.colour).subspan(channels * f, channels);
    std::array<std::int64_t, 4> difference{};
    ColourContext context;
    context.area = area_class(history.areas[f]);
    context.change = old ? change_class(history.areas[f], before->history.areas[match])
                         : ChangingColourModels::kChanges - 1;
    const auto code = [&](std::size_t c, std::int64_t guess) {
      const Around around = coded.around(places, c);
      ResidualModels& alone = models.colour[old ? 1 : 0][c];
      context.last = old ? before->history.changes[channels * match + c] : 0;
      const auto one = [&](std::int64_t& units, std::int64_t expected) {
        if (!before) return code_residual(coder, alone, around, units, expected);
        return code_change(coder, models.changing[old ? 1 : 0][c], alone, around, context, units, expected);
      };
      difference[c] = code_control(one, state.colour_unit, colour[c], prediction[c] + guess);
    };
    // Green goes first where there is one; its error is a good guess of that of red and blue.
    const std::size_t first = channels >= 3 ? 1 : 0;
    code(first, 0);
    context.first = difference[first];
    const std::int64_t guess = channels >= 3 ? difference[1] * state.colour_unit : 0;
    bool second = true;
    for (std::size_t c = 0; c < channels; ++c) {
      if (c == first) continue;
      code(c, c < 3 ? guess : 0);
      if (second) context.second = difference[c];
      second = false;
    }
    for (std::size_t c = 0; old && c < channels; ++c) {
      history.changes[channels * f + c] =
          static_cast<std::int8_t>(std::clamp<std::int64_t>(difference[c], -100, 100));
    }
    std::array<std::int64_t, 4> value{};
    std::copy(colour.begin(), colour.end(), value.begin());
    coded.add(places, value, difference);
  }
}

}  // namespace knotreel::document
