#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/spline/basis.h"
#include "spline/law_cases.h"

/// Spaces and pieces with knots put elsewhere.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr std::uint64_t kSeed = 20260505;

std::vector<Vec2> positions_of(const mesh::KnotMesh& mesh) {
  std::vector<Vec2> positions;
  for (const mesh::Knot& k : mesh.knots) positions.push_back(k.position);
  return positions;
}

/// Free knots moved a little, others at rest.
std::vector<Vec2> jittered(const mesh::KnotMesh& mesh, double reach) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<Vec2> positions = positions_of(mesh);
  for (KnotIndex k = 0; k < positions.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kFree) {
      positions[k] = positions[k] + Vec2{unit(random), unit(random)};
    }
  }
  return positions;
}

bool equal(const Affine& a, const Affine& b) {
  return a.nx == b.nx && a.ny == b.ny && a.px == b.px && a.py == b.py;
}

bool equal(const PieceTerm& a, const PieceTerm& b) {
  if (a.has_factor != b.has_factor || (a.has_factor && !equal(a.factor, b.factor))) return false;
  if (!(a.low == b.low) || !(a.high == b.high)) return false;
  const Tent& s = a.tent;
  const Tent& t = b.tent;
  if (s.slope_count != t.slope_count || s.wall_count != t.wall_count || s.constant != t.constant)
    return false;
  for (std::size_t i = 0; i < std::size_t(s.slope_count); ++i) {
    if (!equal(s.slopes[i], t.slopes[i])) return false;
  }
  for (std::size_t i = 0; i < std::size_t(s.wall_count); ++i) {
    if (!equal(s.walls[i], t.walls[i])) return false;
  }
  return true;
}

class Moved : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Moved, ::testing::Values(1, 2, 3));

TEST_P(Moved, SpacesKeepTheirCombinatorics) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 40)) {
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
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 40)) {
    // Knots off a line that they were on leave gaps in the configs of that line.
    if (knotreel::testing::has_accidental_lines(c.mesh)) continue;
    SCOPED_TRACE(c.name);
    const auto moved =
        std::make_shared<const SplineSpace>(SplineSpace(c.mesh, GetParam()).moved(jittered(c.mesh, 1e-3)));
    const Basis basis(moved);
    std::vector<BasisValue> values;
    double worst = 0;
    for (const Vec2 u : knotreel::testing::probe_points(moved->mesh(), kSeed, 100)) {
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
}

TEST_P(Moved, AShiftedPieceIsThatOfTheMovedSpace) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 10)) {
    if (knotreel::testing::has_accidental_lines(c.mesh)) continue;
    SCOPED_TRACE(c.name);
    const SplineSpace space(c.mesh, GetParam());
    int compared = 0;
    for (KnotIndex k = 0; k < c.mesh.knots.size() && compared < 300; ++k) {
      const mesh::Knot& knot = c.mesh.knots[k];
      Vec2 direction{0.6, -0.8};
      if (knot.kind == KnotKind::kVertex || knot.kind == KnotKind::kSegment) continue;
      if (knot.kind == KnotKind::kBorder) {
        direction = knot.position.x == 0 || knot.position.x == c.mesh.width ? Vec2{0, 1} : Vec2{1, 0};
      }
      std::vector<Vec2> positions = positions_of(c.mesh);
      positions[k] = positions[k] + 1e-5 * direction;
      const PieceSet moved = make_pieces(space.moved(positions));
      for (std::size_t i = 0; i < space.configs().size(); ++i) {
        std::vector<PieceTerm> terms(1);  // what is there already stays in front
        const Piece piece = make_shifted_piece(space, i, {k, positions[k]}, terms);
        const Piece& expected = moved.pieces[i];
        ASSERT_EQ(piece.term_begin, 1u);
        ASSERT_EQ(piece.term_end, terms.size());
        ASSERT_EQ(piece.functions, expected.functions);
        ASSERT_EQ(piece.term_end - piece.term_begin, expected.term_end - expected.term_begin);
        for (std::size_t w = 0; w < 3; ++w) ASSERT_TRUE(equal(piece.weights[w], expected.weights[w]));
        for (std::size_t t = 1; t < terms.size(); ++t) {
          ASSERT_TRUE(equal(terms[t], moved.terms[expected.term_begin + t - 1])) << "config " << i;
        }
        ++compared;
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::spline
