// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/knot_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>
#include <set>

#include "knotreel/mesh/cut_mesh.h"
#include "support/mesh_cases.h"

/// Sound meshes are accepted; each defect, made by one small edit of a sound mesh, is found and named.
namespace knotreel::mesh {
namespace {

using knotreel::testing::MeshBuilder;
using knotreel::testing::MeshCase;

constexpr std::uint64_t kKnotMeshSeed = 20260404;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Knots of sound_mesh(), by what they are. The domain corners are 0 to 3.
constexpr KnotIndex kTopKnot = 4;   // kBorder at (30,0)
constexpr KnotIndex kFreeKnot = 6;  // deep inside
constexpr KnotIndex kTip = 15;      // segment 0: kTip, 18, 19, kBend
constexpr KnotIndex kBend = 16;     // segment 1: kBend, 20, kEnd
constexpr KnotIndex kEnd = 17;      // on the lower side, next to domain corner 2
constexpr KnotIndex kSegmentKnot = 18;

/// 100 x 80 pixels with a feature from a tip over a bend to the border, and a short one without knots inside.
KnotMesh sound_mesh() {
  MeshBuilder b(100, 80);
  b.border(30, 0);
  b.border(0, 43);
  for (const Vec2 p :
       {Vec2{20, 30}, {17, 55}, {31, 44}, {27, 64}, {44, 63}, {45, 12}, {72, 12}, {85, 50}, {66, 24}}) {
    b.free(p.x, p.y);
  }
  const KnotIndex tip = b.vertex(42, 30);
  const KnotIndex bend = b.vertex(60, 40);
  const KnotIndex end = b.vertex(70, 80);
  b.segment(tip, bend, 2);
  b.segment(bend, end, 1);
  b.segment(b.vertex(84, 27), b.vertex(100, 20), 0);
  return b.triangulated();
}

std::set<KnotIndex> neighbours(const KnotMesh& mesh, KnotIndex k) {
  std::set<KnotIndex> result;
  for (const Face& f : mesh.faces) {
    if (std::find(f.begin(), f.end(), k) != f.end()) result.insert(f.begin(), f.end());
  }
  result.erase(k);
  return result;
}

/// A face with three free knots.
std::size_t free_face(const KnotMesh& mesh) {
  const auto it = std::find_if(mesh.faces.begin(), mesh.faces.end(), [&](const Face& f) {
    return std::all_of(f.begin(), f.end(),
                       [&](KnotIndex k) { return mesh.knots[k].kind == KnotKind::kFree; });
  });
  EXPECT_NE(it, mesh.faces.end());
  return static_cast<std::size_t>(it - mesh.faces.begin());
}

void add_torus(KnotMesh& mesh) {
  const auto base = static_cast<KnotIndex>(mesh.knots.size());
  for (KnotIndex i = 0; i < 7; ++i) mesh.knots.push_back({{50, 50}, KnotKind::kFree, KnotId{1000 + i}});
  for (KnotIndex i = 0; i < 7; ++i) {
    const auto at = [&](KnotIndex j) { return base + (i + j) % 7; };
    mesh.faces.push_back({at(0), at(1), at(3)});
    mesh.faces.push_back({at(0), at(3), at(2)});
  }
}

/// Makes knot b the same as knot a.
void merge_knots(KnotMesh& mesh, KnotIndex a, KnotIndex b) {
  const auto last = static_cast<KnotIndex>(mesh.knots.size() - 1);
  for (Face& f : mesh.faces) {
    for (KnotIndex& k : f) k = k == b ? a : k == last ? b : k;
  }
  mesh.knots[b] = mesh.knots[last];
  mesh.knots.pop_back();
}

struct Edit {
  const char* name;
  bool topological;     ///< find_topological_defect sees it too
  const char* message;  ///< part of it
  std::function<void(KnotMesh&)> apply;
};

std::ostream& operator<<(std::ostream& out, const Edit& e) {
  return out << e.name;
}

Vec2& position(KnotMesh& m, KnotIndex k) {
  return m.knots[k].position;
}

const Edit kEdits[] = {
    // Faces.
    {"NoFaces", true, "fewer than", [](KnotMesh& m) { m.faces.clear(); }},
    {"IndexOutOfRange", true, "does not exist", [](KnotMesh& m) { m.faces[3][1] = 4000000000u; }},
    {"IndexJustOutOfRange", true, "does not exist",
     [](KnotMesh& m) { m.faces[3][1] = static_cast<KnotIndex>(m.knots.size()); }},
    {"RepeatedKnot", true, "same knot twice", [](KnotMesh& m) { m.faces[3][1] = m.faces[3][2]; }},
    {"UnusedKnot", true, "belongs to no face",
     [](KnotMesh& m) {
       m.knots.push_back({{50, 50}, KnotKind::kFree, KnotId{1000}});
     }},
    {"FlippedFace", true, "turn different ways",
     [](KnotMesh& m) { std::swap(m.faces[free_face(m)][0], m.faces[free_face(m)][1]); }},
    {"FaceTwice", true, "more than two faces", [](KnotMesh& m) { m.faces.push_back(m.faces[free_face(m)]); }},
    {"Hole", true, "not of a border kind",
     [](KnotMesh& m) { m.faces.erase(m.faces.begin() + static_cast<std::ptrdiff_t>(free_face(m))); }},
    {"TwoBorderLoops", true, "not one loop",
     [](KnotMesh& m) {
       const std::size_t f = free_face(m);
       for (const KnotIndex k : m.faces[f]) m.knots[k].kind = KnotKind::kVertex;
       m.faces.erase(m.faces.begin() + static_cast<std::ptrdiff_t>(f));
     }},
    {"NoBorder", true, "no border",
     [](KnotMesh& m) {
       m.segments.clear();
       m.knots.resize(4);
       m.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
     }},
    {"PinchedOnTheBorder", true, "on the border twice",
     [](KnotMesh& m) {
       m.segments.clear();
       m.knots.resize(5);
       m.faces = {{0, 1, 2}, {0, 3, 4}};
     }},
    {"PinchedInside", true, "share no edge",
     [](KnotMesh& m) {
       for (KnotIndex a = 0; a < m.knots.size(); ++a) {
         for (KnotIndex b = a + 1; b + 1 < m.knots.size(); ++b) {
           if (m.knots[a].kind != KnotKind::kFree || m.knots[b].kind != KnotKind::kFree) continue;
           std::set<KnotIndex> both = neighbours(m, a);
           both.merge(neighbours(m, b));
           if (both.size() < neighbours(m, a).size() + neighbours(m, b).size() || both.contains(a)) continue;
           merge_knots(m, a, b);
           return;
         }
       }
       FAIL() << "no pair of free knots far apart";
     }},
    {"Handle", true, "not a disk",
     [](KnotMesh& m) {
       m.segments.clear();
       m.knots.clear();
       m.faces.clear();
       add_torus(m);
       for (const KnotIndex k : m.faces[0]) m.knots[k].kind = KnotKind::kVertex;
       m.faces.erase(m.faces.begin());
     }},
    {"ClosedPartApart", true, "not in one piece", add_torus},
    // Kinds.
    {"FreeKnotCalledBorder", true, "is not on the border",
     [](KnotMesh& m) { m.knots[kFreeKnot].kind = KnotKind::kBorder; }},
    {"BorderKnotCalledFree", true, "not of a border kind",
     [](KnotMesh& m) { m.knots[kTopKnot].kind = KnotKind::kFree; }},
    {"FreeKnotCalledSegment", true, "on no segment",
     [](KnotMesh& m) { m.knots[kFreeKnot].kind = KnotKind::kSegment; }},
    {"SegmentKnotCalledFree", true, "wrong kind",
     [](KnotMesh& m) { m.knots[kSegmentKnot].kind = KnotKind::kFree; }},
    {"TipCalledSegment", true, "wrong kind", [](KnotMesh& m) { m.knots[kTip].kind = KnotKind::kSegment; }},
    {"FreeKnotCalledVertex", false, "without segments",
     [](KnotMesh& m) { m.knots[kFreeKnot].kind = KnotKind::kVertex; }},
    {"DomainCornerCalledBorder", false, "at a domain corner",
     [](KnotMesh& m) { m.knots[0].kind = KnotKind::kBorder; }},
    // Segments.
    {"SegmentOfOneKnot", true, "fewer than two", [](KnotMesh& m) { m.segments.push_back({{kTip}}); }},
    {"EmptySegment", true, "fewer than two", [](KnotMesh& m) { m.segments.emplace_back(); }},
    {"SegmentIndexOutOfRange", true, "refers to a knot",
     [](KnotMesh& m) { m.segments[0].knots[1] = 4000000000u; }},
    {"SegmentTwice", true, "inside two segments", [](KnotMesh& m) { m.segments.push_back(m.segments[0]); }},
    {"SegmentWithoutInnerKnotsTwice", true, "shares an edge",
     [](KnotMesh& m) { m.segments.push_back(m.segments[2]); }},
    {"SegmentAlongTheBorder", true, "along the border",
     [](KnotMesh& m) {
       m.segments.push_back({{kEnd, 2}});
     }},
    {"SegmentNotAlongEdges", true, "does not follow edges",
     [](KnotMesh& m) {
       m.segments.push_back({{kBend, 0}});
     }},
    {"SegmentOfNoLength", true, "does not follow edges",
     [](KnotMesh& m) {
       m.segments.push_back({{kTip, kTip}});
     }},
    {"SegmentThatReturns", true, "ends where it starts",
     [](KnotMesh& m) {
       const Face f = m.faces[free_face(m)];
       m.knots[f[0]].kind = KnotKind::kVertex;
       m.knots[f[1]].kind = m.knots[f[2]].kind = KnotKind::kSegment;
       m.segments.push_back({{f[0], f[1], f[2], f[0]}});
     }},
    {"TwoTipsWithoutInnerKnot", true, "between two tips",
     [](KnotMesh& m) {
       const Face f = m.faces[free_face(m)];
       m.knots[f[0]].kind = m.knots[f[1]].kind = KnotKind::kVertex;
       m.segments.push_back({{f[0], f[1]}});
     }},
    // Identities.
    {"DuplicateId", false, "same id", [](KnotMesh& m) { m.knots[7].id = m.knots[3].id; }},
    // Positions.
    {"NoWidth", false, "no usable size", [](KnotMesh& m) { m.width = 0; }},
    {"WidthNaN", false, "no usable size", [](KnotMesh& m) { m.width = kNan; }},
    {"HeightInfinite", false, "no usable size", [](KnotMesh& m) { m.height = kInfinity; }},
    {"PositionNaN", false, "outside the domain", [](KnotMesh& m) { position(m, kFreeKnot).x = kNan; }},
    {"BorderPositionNaN", false, "outside the domain", [](KnotMesh& m) { position(m, kTopKnot).y = kNan; }},
    {"PositionInfinite", false, "outside the domain",
     [](KnotMesh& m) { position(m, kFreeKnot).y = -kInfinity; }},
    {"OutsideTheDomain", false, "outside the domain", [](KnotMesh& m) { position(m, kTopKnot).y = -1e-9; }},
    {"BorderKnotOffItsSide", false, "is not on a side", [](KnotMesh& m) { position(m, kTopKnot).y = 1e-9; }},
    {"BorderKnotOnAnotherSide", false, "does not follow a side",
     [](KnotMesh& m) {
       position(m, kTopKnot) = {100, 10};
     }},
    {"FreeKnotOnASide", false, "lies on a side", [](KnotMesh& m) { position(m, kFreeKnot).x = 0; }},
    {"DomainCornerMoved", false, "without segments", [](KnotMesh& m) { position(m, 0).x = 1; }},
    {"DomainOfAnotherSize", false, "", [](KnotMesh& m) { m.width = 101; }},
    {"KnotOffItsSegment", false, "off its segment", [](KnotMesh& m) { position(m, kSegmentKnot).y += 1e-6; }},
    {"KnotsOutOfOrder", false, "out of order",
     [](KnotMesh& m) { std::swap(position(m, kSegmentKnot), position(m, kSegmentKnot + 1)); }},
    {"KnotAtTheEndOfItsSegment", false, "out of order",
     [](KnotMesh& m) { position(m, kSegmentKnot) = position(m, kTip); }},
    {"FaceTurnedOver", false, "flipped or flat",
     [](KnotMesh& m) {
       position(m, kFreeKnot) = {90, 70};
     }},
    {"KnotsCoincide", false, "flipped or flat",
     [](KnotMesh& m) {
       const Face f = m.faces[free_face(m)];
       position(m, f[0]) = position(m, f[1]);
     }},
};

class Defect : public ::testing::TestWithParam<Edit> {};
INSTANTIATE_TEST_SUITE_P(KnotMesh, Defect, ::testing::ValuesIn(kEdits),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Defect, IsFoundAndNamed) {
  KnotMesh mesh = sound_mesh();
  ASSERT_EQ(find_defect(mesh), std::nullopt);
  GetParam().apply(mesh);
  const auto topological = find_topological_defect(mesh);
  EXPECT_EQ(topological.has_value(), GetParam().topological) << topological.value_or("");
  const auto defect = find_defect(mesh);
  ASSERT_TRUE(defect.has_value());
  EXPECT_NE(defect->find(GetParam().message), std::string::npos) << *defect;
  EXPECT_EQ(defect->find('\n'), std::string::npos);
  if (topological) {
    EXPECT_EQ(*topological, *defect);
  }
}

TEST(KnotMesh, CorpusAndRandomMeshesAreSound) {
  std::vector<MeshCase> cases = knotreel::testing::corpus_cases();
  for (MeshCase& c : knotreel::testing::random_cases(kKnotMeshSeed, 50)) cases.push_back(std::move(c));
  for (const MeshCase& c : cases) {
    EXPECT_EQ(find_topological_defect(c.mesh), std::nullopt) << c.to_text();
    EXPECT_EQ(find_defect(c.mesh), std::nullopt) << c.to_text();
  }
}

TEST(KnotMesh, KnotsOnSegmentsMayMissTheLineByRounding) {
  KnotMesh mesh = sound_mesh();
  position(mesh, kSegmentKnot).y += 1e-9;
  EXPECT_EQ(find_defect(mesh), std::nullopt);
}

TEST(KnotMesh, AFaceWithThreeKnotsOnOneSegmentIsADefect) {
  MeshBuilder b(100, 80);
  const KnotIndex apex = b.free(50, 10);
  b.free(50, 70);
  const KnotIndex from = b.vertex(20, 40);
  const KnotIndex to = b.vertex(80, 40);
  b.segment(from, to, 2);
  KnotMesh mesh = b.triangulated();
  const KnotIndex first = mesh.segments[0].knots[1];
  const KnotIndex second = mesh.segments[0].knots[2];
  // The knot moves away from the apex by a rounding error, and the edge between the two is flipped.
  position(mesh, first).y += 1e-9;
  ASSERT_EQ(find_defect(mesh), std::nullopt);
  const auto face = [&](KnotIndex a, KnotIndex c, KnotIndex d) -> Face* {
    for (Face& f : mesh.faces) {
      if (std::is_permutation(f.begin(), f.end(), Face{a, c, d}.begin())) return &f;
    }
    return nullptr;
  };
  Face* one = face(apex, from, first);
  Face* two = face(apex, first, second);
  ASSERT_TRUE(one != nullptr && two != nullptr);
  *one = {from, second, first};
  *two = {apex, second, from};
  if (signed_area(position(mesh, from), position(mesh, second), position(mesh, first)) < 0) {
    std::swap((*one)[1], (*one)[2]);
  }
  if (signed_area(position(mesh, apex), position(mesh, second), position(mesh, from)) < 0) {
    std::swap((*two)[1], (*two)[2]);
  }
  EXPECT_EQ(find_topological_defect(mesh), std::nullopt);
  const auto defect = find_defect(mesh);
  ASSERT_TRUE(defect.has_value());
  EXPECT_NE(defect->find("lies on one segment"), std::string::npos) << *defect;
}

/// One random edit of anything.
void damage(KnotMesh& mesh, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto any_knot = [&] { return static_cast<KnotIndex>(below(mesh.knots.size() + 1)); };
  const double numbers[] = {0, -0.0, 1e-300, 17.25, mesh.width, mesh.height, -1, 1e300, kNan, kInfinity};
  switch (below(12)) {
    case 0:
      mesh.faces[below(mesh.faces.size())][below(3)] = any_knot();
      break;
    case 1:
      std::swap(mesh.faces[below(mesh.faces.size())][0], mesh.faces[below(mesh.faces.size())][1]);
      break;
    case 2:
      mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(below(mesh.faces.size())));
      break;
    case 3:
      mesh.faces.push_back({any_knot(), any_knot(), any_knot()});
      break;
    case 4:
      mesh.knots[below(mesh.knots.size())].kind = static_cast<KnotKind>(below(4));
      break;
    case 5:
      mesh.knots.erase(mesh.knots.begin() + static_cast<std::ptrdiff_t>(below(mesh.knots.size())));
      break;
    case 6:
      mesh.knots[below(mesh.knots.size())].position.x = numbers[below(std::size(numbers))];
      break;
    case 7:
      mesh.knots[below(mesh.knots.size())].position.y = numbers[below(std::size(numbers))];
      break;
    case 8: {
      FeatureSegment s;
      for (std::size_t n = below(5); n > 0; --n) s.knots.push_back(any_knot());
      mesh.segments.push_back(s);
      break;
    }
    case 9:
      if (mesh.segments.empty()) break;
      if (auto& s = mesh.segments[below(mesh.segments.size())].knots; !s.empty())
        s[below(s.size())] = any_knot();
      break;
    case 10:
      if (!mesh.segments.empty()) mesh.segments.erase(mesh.segments.begin());
      break;
    default:
      (below(2) == 0 ? mesh.width : mesh.height) = numbers[below(std::size(numbers))];
  }
}

TEST(KnotMesh, RandomEditsNeverCrash) {
  std::mt19937_64 random(kKnotMeshSeed);
  std::vector<MeshCase> cases = knotreel::testing::corpus_cases();
  for (MeshCase& c : knotreel::testing::random_cases(kKnotMeshSeed, 50)) cases.push_back(std::move(c));
  int still_sound = 0;
  for (const MeshCase& c : cases) {
    for (int i = 0; i < 40; ++i) {
      KnotMesh mesh = c.mesh;
      for (int n = 0; n <= i % 3 && mesh.faces.size() > 2 && mesh.knots.size() > 2; ++n) damage(mesh, random);
      const auto topological = find_topological_defect(mesh);
      const auto defect = find_defect(mesh);
      if (topological) {
        EXPECT_EQ(topological, defect);
      } else {
        // What has no topological defect can be cut, wherever its knots are.
        EXPECT_EQ(cut_open(mesh).faces.size(), mesh.faces.size());
      }
      still_sound += defect.has_value() ? 0 : 1;
    }
  }
  EXPECT_GT(still_sound, 0);
  EXPECT_LT(still_sound, static_cast<int>(cases.size()) * 20);
}

}  // namespace
}  // namespace knotreel::mesh
