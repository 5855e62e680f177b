// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/spline/basis.h"
#include "spline/law_cases.h"
#include "spline/tent.h"

/// Spaces and pieces with knots put elsewhere.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr std::uint64_t kMovedSeed = 20260505;

std::vector<Vec2> positions_of(const mesh::KnotMesh& mesh) {
  std::vector<Vec2> positions;
  for (const mesh::Knot& k : mesh.knots) positions.push_back(k.position);
  return positions;
}

/// Free knots moved a little, others at rest.
std::vector<Vec2> jittered(const mesh::KnotMesh& mesh, double reach) {
  std::mt19937_64 random(kMovedSeed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<Vec2> positions = positions_of(mesh);
  for (KnotIndex k = 0; k < positions.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kFree) {
      positions[k] = positions[k] + Vec2{unit(random), unit(random)};
    }
  }
  return positions;
}

/// A direction in which a knot may move; zero for those that may not.
Vec2 direction_of(const mesh::KnotMesh& mesh, KnotIndex k) {
  const mesh::Knot& knot = mesh.knots[k];
  if (knot.kind == KnotKind::kFree) return {0.6, -0.8};
  if (knot.kind == KnotKind::kBorder) {
    return knot.position.x == 0 || knot.position.x == mesh.width ? Vec2{0, 1} : Vec2{1, 0};
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      if (s.knots[i] != k) continue;
      const Vec2 along = mesh.knots[s.knots.back()].position - mesh.knots[s.knots.front()].position;
      return (1 / norm(along)) * along;
    }
  }
  return {};
}

double value_of(const Piece& piece, std::span<const PieceTerm> terms, Vec2 u, std::size_t weight) {
  double sum = 0;
  for (const PieceTerm& t : terms) {
    sum += tent_value(t.tent, u, Vec2{0.3, 0.7}) * (t.has_factor ? t.factor(u) : 1.0);
  }
  return sum * piece.weights[weight](u);
}

class Moved : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Moved, ::testing::Values(1, 2, 3));

TEST_P(Moved, SpacesKeepTheirCombinatorics) {
  for (const MeshCase& c : knotreel::testing::law_cases(kMovedSeed, 40)) {
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    mesh::KnotMesh there = c.mesh;
    const std::vector<Vec2> positions = jittered(c.mesh, 1e-3);
    for (KnotIndex k = 0; k < there.knots.size(); ++k) there.knots[k].position = positions[k];
    const SplineSpace moved = space.moved(positions);
    const SplineSpace built = SplineSpace::from_link_codes(there, GetParam(), space.link_codes());
    EXPECT_EQ(positions_of(moved.mesh()), positions);
    EXPECT_EQ(positions_of(space.mesh()), positions_of(c.mesh)) << "the original stays";
    ASSERT_EQ(moved.function_count(), built.function_count());
    ASSERT_EQ(moved.geometry_count(), built.geometry_count());
    EXPECT_TRUE(std::ranges::equal(moved.geometry_of(), built.geometry_of()));
    EXPECT_TRUE(std::ranges::equal(moved.link_codes(), built.link_codes()));
    for (FunctionIndex f = 0; f < moved.function_count(); ++f) {
      ASSERT_EQ(moved.functions()[f].knots, built.functions()[f].knots);
      ASSERT_EQ(moved.greville(f), built.greville(f));
    }
    ASSERT_EQ(moved.configs().size(), built.configs().size());
    for (std::size_t i = 0; i < moved.configs().size(); ++i) {
      ASSERT_EQ(moved.configs()[i].triangle, built.configs()[i].triangle);
      ASSERT_EQ(moved.configs()[i].inner, built.configs()[i].inner);
      ASSERT_EQ(moved.configs()[i].functions, built.configs()[i].functions);
    }
  }
}

TEST_P(Moved, SpacesReproduceLinearFunctions) {
  int cases = 0;
  for (const MeshCase& c : knotreel::testing::law_cases(kMovedSeed, 40)) {
    // Knots off a line that they were on leave gaps in the configs of that line.
    if (knotreel::testing::has_accidental_lines(c.mesh)) continue;
    ++cases;
    SCOPED_TRACE(c.name);
    const auto moved =
        std::make_shared<const SplineSpace>(SplineSpace(c.mesh, GetParam()).moved(jittered(c.mesh, 1e-3)));
    const Basis basis(moved);
    std::vector<BasisValue> values;
    double worst = 0;
    for (const Vec2 u : knotreel::testing::probe_points(moved->mesh(), kMovedSeed, 100)) {
      basis.evaluate(u, values);
      Vec2 sum;
      double one = 0;
      for (const BasisValue& v : values) {
        one += v.value;
        sum = sum + v.value * moved->greville(v.function);
      }
      worst = std::max({worst, std::abs(one - 1), norm(sum - u) / std::max(c.mesh.width, c.mesh.height)});
    }
    EXPECT_LE(worst, 1e-9) << c.to_text();
  }
  EXPECT_GT(cases, 20);
}

TEST_P(Moved, AShiftedPieceIsThatOfTheMovedSpace) {
  for (const MeshCase& c : knotreel::testing::law_cases(kMovedSeed, 10)) {
    if (knotreel::testing::has_accidental_lines(c.mesh)) continue;
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    std::mt19937_64 random(kMovedSeed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (KnotIndex k = 0; k < c.mesh.knots.size(); k += 1 + KnotIndex(c.mesh.knots.size()) / 15) {
      const Vec2 direction = direction_of(c.mesh, k);
      if (direction == Vec2{}) continue;
      std::vector<Vec2> positions = positions_of(c.mesh);
      positions[k] = positions[k] + 1e-3 * direction;
      const PieceSet moved = make_pieces(space.moved(positions));
      for (std::size_t i = 0; i < space.configs().size(); ++i) {
        std::vector<PieceTerm> terms(1);  // what is there already stays in front
        const Piece piece = make_shifted_piece(space, i, {k, positions[k]}, terms);
        const Piece& expected = moved.pieces[i];
        ASSERT_EQ(piece.term_begin, 1u);
        ASSERT_EQ(piece.term_end, terms.size());
        ASSERT_EQ(piece.functions, expected.functions);
        ASSERT_EQ(piece.term_end - piece.term_begin, expected.term_end - expected.term_begin);
        if (terms.size() == 1) continue;
        const auto expected_terms =
            std::span(moved.terms).subspan(expected.term_begin, expected.term_end - expected.term_begin);
        const Vec2 low = expected_terms[0].low;
        const Vec2 high = expected_terms[0].high;
        for (std::size_t t = 0; t < expected_terms.size(); ++t) {
          ASSERT_EQ(terms[t + 1].low, low);
          ASSERT_EQ(terms[t + 1].high, high);
        }
        for (int n = 0; n < 5; ++n) {
          const Vec2 u{low.x + unit(random) * (high.x - low.x), low.y + unit(random) * (high.y - low.y)};
          for (std::size_t w = 0; w < 3; ++w) {
            ASSERT_NEAR(value_of(piece, std::span(terms).subspan(1), u, w),
                        value_of(expected, expected_terms, u, w), 1e-9)
                << "config " << i;
          }
        }
      }
    }
  }
}

/// Derivatives are differences of coefficients: terms must come in the same order, with the same slopes, even
/// where the triangles that a piece could be cut by have equal areas.
TEST_P(Moved, AHardlyShiftedPieceHasHardlyShiftedCoefficients) {
  for (const MeshCase& c : knotreel::testing::law_cases(kMovedSeed, 10)) {
    if (knotreel::testing::has_accidental_lines(c.mesh)) continue;
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    const PieceSet set = make_pieces(space);
    const auto expect_close = [](const Affine& a, const Affine& b) {
      const double size = 1e-4 * (std::abs(b.nx) + std::abs(b.ny));
      ASSERT_NEAR(a.nx, b.nx, size);
      ASSERT_NEAR(a.ny, b.ny, size);
    };
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) {
      const Vec2 along = direction_of(c.mesh, k);
      for (const double step : {1e-9, -1e-9}) {
        if (along == Vec2{}) continue;
        for (std::size_t i = 0; i < space.configs().size(); ++i) {
          std::vector<PieceTerm> terms;
          make_shifted_piece(space, i, {k, c.mesh.knots[k].position + step * along}, terms);
          const Piece& piece = set.pieces[i];
          ASSERT_EQ(terms.size(), piece.term_end - piece.term_begin);
          for (std::size_t t = 0; t < terms.size(); ++t) {
            SCOPED_TRACE("knot " + std::to_string(k) + " config " + std::to_string(i));
            const PieceTerm& at_rest = set.terms[piece.term_begin + t];
            ASSERT_EQ(terms[t].has_factor, at_rest.has_factor);
            if (terms[t].has_factor) expect_close(terms[t].factor, at_rest.factor);
            ASSERT_EQ(terms[t].tent.slope_count, at_rest.tent.slope_count);
            for (std::size_t s = 0; s < std::size_t(at_rest.tent.slope_count); ++s) {
              expect_close(terms[t].tent.slopes[s], at_rest.tent.slopes[s]);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::spline
