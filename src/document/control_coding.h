// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
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

}  // namespace knotreel::document
