#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "document/frame_state.h"
#include "document/identity.h"
#include "document/residuals.h"

/// Control points as differences from predictions (docs/format.md, "Control points").
namespace knotreel::document {

/// Mean of the vectors coded so far whose basis functions share a knot with the next one, over corners or
/// knots.
/// @tparam Size  length of the vectors.
template <std::size_t Size>
class RunningMeans {
 public:
  using Vector = std::array<std::int64_t, Size>;

  explicit RunningMeans(std::size_t place_count) : sums_(place_count) {}

  Vector predict(std::span<const std::uint32_t> places) const {
    Vector sum{};
    std::int64_t count = 0;
    for (const std::uint32_t p : places) {
      for (std::size_t i = 0; i < Size; ++i) sum[i] += sums_[p].sum[i];
      count += sums_[p].count;
    }
    if (count == 0) return last_;
    // Rounded to the nearest, halves up.
    for (std::int64_t& s : sum) s = floor_div(2 * s + count, 2 * count);
    return sum;
  }

  void add(std::span<const std::uint32_t> places, const Vector& value) {
    for (const std::uint32_t p : places) {
      for (std::size_t i = 0; i < Size; ++i) sums_[p].sum[i] += value[i];
      ++sums_[p].count;
    }
    last_ = value;
  }

 private:
  struct Sum {
    Vector sum{};
    std::int64_t count = 0;
  };
  static std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    return a / b - ((a % b != 0 && a < 0) ? 1 : 0);
  }

  std::vector<Sum> sums_;
  Vector last_{};
};

inline void require_control(std::int64_t v) {
  if (v < -kMaxControl || v > kMaxControl) malformed("a control point is out of range");
}

/// @param before  null for a keyframe.
template <class Residuals>
void code_displacements(Residuals& residuals, FrameState& state, const FrameState* before,
                        const Matches& matches) {
  const spline::SplineSpace& space = *state.space;
  std::vector<spline::FunctionIndex> first(space.geometry_count(), spline::kNoFunction);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    spline::FunctionIndex& any = first[space.geometry_of()[f]];
    if (any == spline::kNoFunction) any = f;
  }
  const auto degree = static_cast<std::size_t>(space.degree());
  RunningMeans<2> means(space.mesh().knots.size());
  for (std::uint32_t g = 0; g < space.geometry_count(); ++g) {
    std::array<std::uint32_t, spline::kMaxDegree> knots{};
    for (std::size_t i = 0; i < degree; ++i) {
      knots[i] = space.cut().corners[space.functions()[first[g]].knots[i]].knot;
    }
    const auto places = std::span(knots).first(degree);
    auto prediction = means.predict(places);
    if (before && matches.groups[g] != kNoMatch) {
      prediction = {before->displacement[2 * matches.groups[g]],
                    before->displacement[2 * matches.groups[g] + 1]};
    }
    std::int64_t& x = state.displacement[2 * g];
    std::int64_t& y = state.displacement[2 * g + 1];
    residuals.code(stream::kDisplacementX, x, prediction[0]);
    residuals.code(stream::kDisplacementY, y, prediction[1]);
    require_control(x);
    require_control(y);
    means.add(places, {x, y});
  }
}

/// @param before  null for a keyframe.
template <class Residuals>
void code_colours(Residuals& residuals, FrameState& state, const FrameState* before, const Matches& matches,
                  std::size_t channels) {
  const spline::SplineSpace& space = *state.space;
  const auto degree = static_cast<std::size_t>(space.degree());
  RunningMeans<4> means(space.cut().corners.size());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const auto places = std::span(space.functions()[f].knots).first(degree);
    auto prediction = means.predict(places);
    if (before && matches.functions[f] != kNoMatch) {
      const auto was = std::span(before->colour).subspan(channels * matches.functions[f], channels);
      std::copy(was.begin(), was.end(), prediction.begin());
    }
    const auto colour = std::span(state.colour).subspan(channels * f, channels);
    // Green goes first where there is one; its error is a good guess of that of red and blue.
    std::int64_t guess = 0;
    if (channels >= 3) {
      residuals.code(stream::kColour + 1, colour[1], prediction[1]);
      require_control(colour[1]);
      guess = colour[1] - prediction[1];
    }
    for (std::size_t c = 0; c < channels; ++c) {
      if (channels >= 3 && c == 1) continue;
      residuals.code(stream::kColour + c, colour[c], prediction[c] + (c < 3 ? guess : 0));
      require_control(colour[c]);
    }
    std::array<std::int64_t, 4> value{};
    std::copy(colour.begin(), colour.end(), value.begin());
    means.add(places, value);
  }
}

}  // namespace knotreel::document
