// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/conquest.h"

#include <gtest/gtest.h>

#include <random>

#include "document/bytes.h"
#include "document/canonical.h"
#include "document/identity.h"
#include "document/sample_models.h"
#include "document/topology_coding.h"
#include "support/mesh_cases.h"

namespace knotreel::document {
namespace {

Topology topology_of(const CanonicalMesh& canonical) {
  return {canonical.mesh, canonical.conquest.discoveries, canonical.border_count, canonical.domain_corners,
          std::vector<std::uint32_t>(canonical.mesh.knots.size(), kNoMatch)};
}

TEST(Conquest, ReadingGivesTheSameTopology) {
  auto cases = testing::corpus_cases();
  for (auto& c : testing::random_cases(3, 100)) cases.push_back(std::move(c));
  cases.push_back({"large", testing::random_mesh(640, 480, 5000, 20, 1)});
  for (const testing::MeshCase& c : cases) {
    SCOPED_TRACE(c.name);
    const CanonicalMesh canonical = canonical_mesh(c.mesh);
    ArithmeticWriter out;
    TopologyModels written;
    write_topology(topology_of(canonical), nullptr, written, out);
    const std::vector<std::byte> bytes = out.finish();
    ArithmeticReader in(bytes);
    TopologyModels read;
    const Topology again = read_topology(c.mesh.knots.size(), nullptr, read, in);
    EXPECT_EQ(again.mesh.faces, canonical.conquest.faces);
    EXPECT_EQ(again.border_count, canonical.border_count);
    EXPECT_EQ(again.domain_corners, canonical.domain_corners);
    EXPECT_NO_THROW(in.require_end());
    EXPECT_FALSE(mesh::find_defect(canonical.mesh));
  }
}

TEST(Conquest, NumbersACanonicalMeshTheSameWay) {
  for (const testing::MeshCase& c : testing::random_cases(4, 50)) {
    const CanonicalMesh once = canonical_mesh(c.mesh);
    const CanonicalMesh twice = canonical_mesh(once.mesh);
    EXPECT_EQ(twice.mesh.faces, once.mesh.faces);
    EXPECT_EQ(twice.conquest.faces, once.conquest.faces);
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

TEST(Conquest, RandomBytesEndInAMeshOrInMalformed) {
  std::mt19937_64 random(5);
  int meshes = 0;
  for (int i = 0; i < 100000; ++i) {
    std::vector<std::byte> bytes(random() % 24);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    ArithmeticReader in(bytes);
    TopologyModels models;
    try {
      const Topology t = read_topology(40, nullptr, models, in);
      const std::size_t knots = t.mesh.knots.size();
      ASSERT_LE(knots, 40u);
      ASSERT_EQ(t.mesh.faces.size(), 2 * knots - t.border_count - 2);
      for (const Face& f : t.mesh.faces) {
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
