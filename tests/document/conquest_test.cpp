#include "document/conquest.h"

#include <gtest/gtest.h>

#include <random>

#include "document/bytes.h"
#include "document/canonical.h"
#include "document/sample_models.h"
#include "support/mesh_cases.h"

namespace knotreel::document {
namespace {

TEST(Conquest, ReplayGivesTheSameFaces) {
  auto cases = testing::corpus_cases();
  for (auto& c : testing::random_cases(3, 100)) cases.push_back(std::move(c));
  cases.push_back({"large", testing::random_mesh(640, 480, 5000, 20, 1)});
  for (const testing::MeshCase& c : cases) {
    SCOPED_TRACE(c.name);
    const CanonicalMesh canonical = canonical_mesh(c.mesh);
    Symbols<std::uint8_t> steps(canonical.conquest.steps);
    Symbols<std::uint64_t> splits(canonical.conquest.splits);
    const Conquest again = replay(c.mesh.knots.size(), canonical.border_count, steps, splits);
    EXPECT_EQ(again.faces, canonical.conquest.faces);
    EXPECT_TRUE(steps.used_up());
    EXPECT_TRUE(splits.used_up());
    EXPECT_FALSE(mesh::find_defect(canonical.mesh));
  }
}

TEST(Conquest, NumbersACanonicalMeshTheSameWay) {
  for (const testing::MeshCase& c : testing::random_cases(4, 50)) {
    const CanonicalMesh once = canonical_mesh(c.mesh);
    const CanonicalMesh twice = canonical_mesh(once.mesh);
    EXPECT_EQ(twice.mesh.faces, once.mesh.faces);
    EXPECT_EQ(twice.conquest.steps, once.conquest.steps);
    for (KnotIndex k = 0; k < twice.knot_of.size(); ++k) EXPECT_EQ(twice.knot_of[k], k);
  }
}

TEST(Conquest, RefusesASplitTheLongWayRound) {
  // Else hostile splits could make the walks quadratic. A border of twelve: 0 1 ... 11, gate (0,1).
  const auto split = [](std::uint64_t code) {
    Loops loops(12);
    return loops.split(code);
  };
  EXPECT_EQ(split(2 * 1), 4u);
  EXPECT_EQ(split(2 * 1 + 1), 9u);
  EXPECT_EQ(split(2 * 3), 6u);
  EXPECT_EQ(split(2 * 3 + 1), 7u);
  EXPECT_THROW(split(2 * 4), Malformed);
  EXPECT_THROW(split(2 * 4 + 1), Malformed);
  EXPECT_THROW(split(~0ull), Malformed);
}

TEST(Conquest, RandomSymbolsEndInAMeshOrInMalformed) {
  std::mt19937_64 random(5);
  int meshes = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::size_t border = 4 + random() % 8;
    const std::size_t knots = border + random() % 8;
    std::vector<std::uint8_t> symbols(2 * knots);
    std::vector<std::uint64_t> offsets(8);
    for (auto& s : symbols) s = static_cast<std::uint8_t>(random() % 4);
    for (auto& o : offsets) o = random() % 4;
    Symbols<std::uint8_t> steps(symbols);
    Symbols<std::uint64_t> splits(offsets);
    try {
      const Conquest c = replay(knots, border, steps, splits);
      ASSERT_EQ(c.faces.size(), 2 * knots - border - 2);
      for (const Face& f : c.faces) {
        for (const KnotIndex k : f) ASSERT_LT(k, knots);
      }
      ++meshes;
    } catch (const Malformed&) {
    }
  }
  EXPECT_GT(meshes, 100);
}

}  // namespace
}  // namespace knotreel::document
