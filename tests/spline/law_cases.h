// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/mesh_cases.h"

/// The meshes of all tests in this folder. The same tests make two programs: spline_laws_test with all cases,
/// and spline_unit_test with few, which is fast enough for every build, sanitizers included.
namespace knotreel::testing {

/// Larger spaces are left out of tests whose cost is cubic in the number of functions.
extern const std::size_t kMostDenseFunctions;

/// The corpus, or every third case of it, and then `random_count` random meshes, or the few allowed.
std::vector<MeshCase> law_cases(std::uint64_t seed, int random_count);

}  // namespace knotreel::testing
