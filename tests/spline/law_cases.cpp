// SPDX-License-Identifier: GPL-3.0-or-later
#include "spline/law_cases.h"

#include <algorithm>
#include <utility>

namespace knotreel::testing {

namespace {

#ifdef KNOTREEL_LAW_CASES
constexpr int kMostRandomCases = KNOTREEL_LAW_CASES;
constexpr std::size_t kCorpusStride = 3;
#else
constexpr int kMostRandomCases = 1000000;
constexpr std::size_t kCorpusStride = 1;
#endif

}  // namespace

#ifdef KNOTREEL_LAW_CASES
const std::size_t kMostDenseFunctions = 120;
#else
const std::size_t kMostDenseFunctions = 1000000;
#endif

std::vector<MeshCase> law_cases(std::uint64_t seed, int random_count) {
  std::vector<MeshCase> all;
  std::vector<MeshCase> corpus = corpus_cases();
  for (std::size_t i = 0; i < corpus.size(); i += kCorpusStride) all.push_back(std::move(corpus[i]));
  for (MeshCase& c : random_cases(seed, std::min(random_count, kMostRandomCases)))
    all.push_back(std::move(c));
  return all;
}

}  // namespace knotreel::testing
