// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/matching.h"

#include <algorithm>
#include <array>
#include <utility>

namespace knotreel::track {

namespace {

using Name = std::array<std::uint32_t, 3>;  ///< ids of the knots, ascending
using NamedFunction = std::pair<Name, spline::FunctionIndex>;

/// All functions by name; functions of the same name follow each other.
std::vector<NamedFunction> functions_by_name(const spline::SplineSpace& space) {
  std::vector<NamedFunction> result;
  result.reserve(space.function_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    Name name;
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::CornerIndex c = space.functions()[f].knots[i];
      name[i] = c == spline::kNoCorner
                    ? 0xffffffffU
                    : static_cast<std::uint32_t>(space.mesh().knots[space.cut().corners[c].knot].id);
    }
    std::sort(name.begin(), name.end());
    result.emplace_back(name, f);
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

std::vector<std::uint32_t> match_functions(const spline::SplineSpace& from, const spline::SplineSpace& to) {
  std::vector<std::uint32_t> match(to.function_count(), kNoMatch);
  const std::vector<NamedFunction> old_functions = functions_by_name(from);
  const std::vector<NamedFunction> functions = functions_by_name(to);
  const auto end_of_name = [](const std::vector<NamedFunction>& list, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < list.size() && list[end].first == list[begin].first) ++end;
    return end;
  };
  // Both lists are walked together, name by name.
  for (std::size_t i = 0, j = 0; i < functions.size() && j < old_functions.size();) {
    const std::size_t i_end = end_of_name(functions, i);
    const std::size_t j_end = end_of_name(old_functions, j);
    if (functions[i].first == old_functions[j].first) {
      const std::size_t count = i_end - i == j_end - j ? i_end - i : 0;
      for (std::size_t k = 0; k < count; ++k) {
        match[functions[i + k].second] = old_functions[j + k].second;
      }
      i = i_end;
      j = j_end;
    } else if (functions[i].first < old_functions[j].first) {
      i = i_end;
    } else {
      j = j_end;
    }
  }
  return match;
}

}  // namespace knotreel::track
