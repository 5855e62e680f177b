// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/mesh_cases.h"

/// The meshes of all tests in this folder. The same sources make two programs: spline_laws_test with all
/// cases, and spline_unit_test with few, which is fast enough for every build, sanitizers included.
namespace knotreel::testing {

// kMostDenseFunctions: larger spaces are left out of tests whose cost is cubic in the number of functions.
#ifdef KNOTREEL_LAW_CASES
inline constexpr int kMostRandomCases = KNOTREEL_LAW_CASES;
inline constexpr std::size_t kMostDenseFunctions = 120;
inline constexpr std::size_t kCorpusStride = 3;
#else
inline constexpr int kMostRandomCases = 1000000;
inline constexpr std::size_t kMostDenseFunctions = 1000000;
inline constexpr std::size_t kCorpusStride = 1;
#endif

/// The corpus, or every third case of it, and then `random_count` random meshes, or the few allowed.
inline std::vector<MeshCase> law_cases(std::uint64_t seed, int random_count) {
  std::vector<MeshCase> all;
  std::vector<MeshCase> corpus = corpus_cases();
  for (std::size_t i = 0; i < corpus.size(); i += kCorpusStride) all.push_back(std::move(corpus[i]));
  for (MeshCase& c : random_cases(seed, std::min(random_count, kMostRandomCases)))
    all.push_back(std::move(c));
  return all;
}

}  // namespace knotreel::testing
