// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/fingerprint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "knotreel/base/parallel.h"
#include "spline/law_cases.h"

namespace knotreel::spline {
namespace {

using knotreel::testing::law_cases;
using knotreel::testing::probe_points;
using mesh::KnotIndex;

constexpr std::uint64_t kFingerprintSeed = 20261125;

/// Functions with a config that has a corner of this knot.
std::set<FunctionIndex> functions_around(const SplineSpace& space, KnotIndex knot) {
  const auto is_there = [&](CornerIndex c) { return c != kNoCorner && space.cut().corners[c].knot == knot; };
  std::set<FunctionIndex> result;
  for (const Config& c : space.configs()) {
    if (std::ranges::any_of(c.triangle, is_there) || std::ranges::any_of(c.inner, is_there))
      result.insert(c.functions.begin(), c.functions.end());
  }
  return result;
}

double value_of(const Basis& basis, FunctionIndex f, Vec2 u) {
  std::vector<BasisValue> values;
  basis.evaluate(u, values);
  for (const BasisValue& v : values) {
    if (v.function == f) return v.value;
  }
  return 0;
}

/// A knot is put elsewhere: the functions around it change, and no other.
TEST(Fingerprints, ChangeWithTheirFunctions) {
  std::mt19937_64 random(kFingerprintSeed);
  std::size_t changed = 0;
  std::size_t kept = 0;
  for (const auto& c : law_cases(kFingerprintSeed, 20)) {
    std::vector<KnotIndex> free;
    std::vector<Vec2> positions;
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) {
      positions.push_back(c.mesh.knots[k].position);
      if (c.mesh.knots[k].kind == mesh::KnotKind::kFree) free.push_back(k);
    }
    if (free.empty()) continue;
    const KnotIndex knot = free[random() % free.size()];
    positions[knot] = positions[knot] + Vec2{0x1p-10, 0x1p-11};
    for (const int degree : {1, 2, 3}) {
      const auto space = std::make_shared<const SplineSpace>(c.mesh, degree);
      const Basis before(space);
      const Basis after(std::make_shared<const SplineSpace>(space->moved(positions)));
      const std::vector<std::uint64_t> old_prints = function_fingerprints(before);
      const std::vector<std::uint64_t> prints = function_fingerprints(after);
      ASSERT_EQ(prints.size(), space->function_count());
      const std::set<FunctionIndex> around = functions_around(*space, knot);
      for (FunctionIndex f = 0; f < prints.size(); ++f) {
        if (!around.count(f)) {
          ASSERT_EQ(prints[f], old_prints[f]) << c.name << ", function " << f;
        }
        (prints[f] == old_prints[f] ? kept : changed) += 1;
      }
      for (const Vec2 u : probe_points(c.mesh, kFingerprintSeed, 20)) {
        for (const FunctionIndex f : around) {
          if (f == kNoFunction || prints[f] != old_prints[f]) continue;
          ASSERT_EQ(value_of(before, f, u), value_of(after, f, u)) << c.name << ", function " << f;
        }
      }
    }
  }
  EXPECT_GT(changed, 0u);
  EXPECT_GT(kept, changed);
}

TEST(Fingerprints, AreAllDifferentAndDoNotDependOnThreads) {
  for (const auto& c : law_cases(kFingerprintSeed + 1, 10)) {
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, 2));
    std::vector<std::uint64_t> prints = function_fingerprints(basis);
    const ThreadCap one(1);
    ASSERT_EQ(function_fingerprints(basis), prints) << c.name;
    std::sort(prints.begin(), prints.end());
    ASSERT_EQ(std::adjacent_find(prints.begin(), prints.end()), prints.end()) << c.name;
  }
}

}  // namespace
}  // namespace knotreel::spline
