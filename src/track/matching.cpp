#include "track/matching.h"

#include <algorithm>
#include <array>
#include <map>

namespace knotreel::track {

namespace {

using Name = std::array<std::uint32_t, 3>;
using ByName = std::map<Name, std::vector<spline::FunctionIndex>>;

ByName functions_by_name(const spline::SplineSpace& space) {
  ByName result;
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    Name name;
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::CornerIndex c = space.functions()[f].knots[i];
      name[i] = c == spline::kNoCorner
                    ? 0xffffffffU
                    : static_cast<std::uint32_t>(space.mesh().knots[space.cut().corners[c].knot].id);
    }
    std::sort(name.begin(), name.end());
    result[name].push_back(f);
  }
  return result;
}

}  // namespace

std::vector<std::uint32_t> match_functions(const spline::SplineSpace& from, const spline::SplineSpace& to) {
  std::vector<std::uint32_t> match(to.function_count(), kNoMatch);
  const ByName old_functions = functions_by_name(from);
  for (const auto& [name, functions] : functions_by_name(to)) {
    const auto known = old_functions.find(name);
    if (known == old_functions.end() || known->second.size() != functions.size()) continue;
    for (std::size_t i = 0; i < functions.size(); ++i) match[functions[i]] = known->second[i];
  }
  return match;
}

}  // namespace knotreel::track
