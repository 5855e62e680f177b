#include "knotreel/spline/space.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/spline/link.h"
#include "spline/family.h"

namespace knotreel::spline {

/// Runs the link triangulation procedure up to level degree - 1 and names the functions.
class SpaceBuilder {
 public:
  SpaceBuilder(SplineSpace& space, mesh::KnotMesh mesh, int degree) : space_(space) {
    if (degree < 1 || degree > kMaxDegree) {
      throw Error(ErrorKind::kInvalidArgument, "the degree of a spline space is 1, 2 or 3");
    }
    space_.degree_ = degree;
    space_.mesh_ = std::move(mesh);
    space_.cut_ = mesh::cut_open(space_.mesh_);
  }

  void run(const Triangulator& triangulator) {
    std::vector<FamilyConfig> family = face_family(space_.cut_);
    std::vector<std::uint32_t> place(space_.cut_.corners.size(), kNotOnPath);
    for (int level = 0; level + 1 < space_.degree_; ++level) {
      std::vector<FamilyConfig> next;
      for_each_vertex(family, level, [&](LinkVertex& vertex) {
        const std::array<CornerIndex, 2> inner{vertex.knots[0], vertex.knots[1]};
        for (const auto& t : link_triangles(space_, vertex, level, triangulator, place)) {
          next.push_back({t, inner});
        }
      });
      family = std::move(next);
    }
    name_functions(family);
    group_by_geometry();
  }

  std::vector<std::uint16_t>& codes() { return space_.link_codes_; }

 private:
  void name_functions(const std::vector<FamilyConfig>& family) {
    space_.configs_.reserve(family.size());
    for (const FamilyConfig& c : family) {
      space_.configs_.push_back({c.triangle, c.inner, {kNoFunction, kNoFunction, kNoFunction}});
    }
    for_each_vertex(family, space_.degree_ - 1, [&](LinkVertex& vertex) {
      if (vertex.edges.empty()) return;  // an empty link: the function vanishes everywhere
      const auto f = static_cast<FunctionIndex>(space_.functions_.size());
      space_.functions_.push_back({vertex.knots});
      for (const std::uint32_t m : vertex.members) space_.configs_[m / 3].functions[m % 3] = f;
    });
  }

  void group_by_geometry() {
    struct Keyed {
      std::array<mesh::KnotIndex, 3> knots;
      FunctionIndex function;
    };
    std::vector<Keyed> keyed(space_.functions_.size());
    for (FunctionIndex f = 0; f < keyed.size(); ++f) {
      keyed[f].function = f;
      for (std::size_t i = 0; i < 3; ++i) {
        const CornerIndex c = space_.functions_[f].knots[i];
        keyed[f].knots[i] = c == kNoCorner ? kNoCorner : space_.cut_.corners[c].knot;
      }
      std::sort(keyed[f].knots.begin(), keyed[f].knots.end());
    }
    std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
      return a.knots != b.knots ? a.knots < b.knots : a.function < b.function;
    });
    space_.geometry_of_.resize(keyed.size());
    for (std::size_t i = 0; i < keyed.size(); ++i) {
      if (i > 0 && keyed[i].knots != keyed[i - 1].knots) ++space_.geometry_count_;
      space_.geometry_of_[keyed[i].function] = static_cast<std::uint32_t>(space_.geometry_count_);
    }
    if (!keyed.empty()) ++space_.geometry_count_;
  }

  SplineSpace& space_;
};

namespace {

void require_sound(const std::optional<std::string>& defect, ErrorKind kind) {
  if (defect) throw Error(kind, "the knot mesh is not sound: " + *defect);
}

void delaunay_policy(const LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
  encode_triangulation(polygon.corners.size(), triangulate_polygon(polygon.positions), codes);
}

}  // namespace

SplineSpace::SplineSpace(mesh::KnotMesh mesh, int degree)
    : SplineSpace(std::move(mesh), degree, delaunay_policy) {}

SplineSpace::SplineSpace(mesh::KnotMesh mesh, int degree, const LinkPolicy& policy) {
  require_sound(mesh::find_defect(mesh), ErrorKind::kInvalidArgument);
  SpaceBuilder builder(*this, std::move(mesh), degree);
  builder.run([&](const LinkPolygon& polygon, std::vector<PolygonTriangle>& triangles) {
    const std::size_t before = builder.codes().size();
    policy(polygon, builder.codes());
    const auto chosen = std::span(builder.codes()).subspan(before);
    const auto used = decode_triangulation(polygon.corners.size(), chosen, triangles);
    if (!used || *used != chosen.size()) {
      throw Error(ErrorKind::kInvalidArgument, "a link policy gave codes that do not fit its polygon");
    }
  });
}

SplineSpace SplineSpace::from_link_codes(mesh::KnotMesh mesh, int degree,
                                         std::span<const std::uint16_t> codes) {
  require_sound(mesh::find_topological_defect(mesh), ErrorKind::kInput);
  SplineSpace space;
  SpaceBuilder builder(space, std::move(mesh), degree);
  std::size_t at = 0;
  builder.run([&](const LinkPolygon& polygon, std::vector<PolygonTriangle>& triangles) {
    const auto used = decode_triangulation(polygon.corners.size(), codes.subspan(at), triangles);
    if (!used) throw Error(ErrorKind::kInput, "the link codes do not fit the knot mesh");
    at += *used;
  });
  if (at != codes.size()) throw Error(ErrorKind::kInput, "more link codes than the knot mesh has links");
  builder.codes().assign(codes.begin(), codes.end());
  return space;
}

SplineSpace SplineSpace::moved(std::span<const Vec2> positions) const {
  SplineSpace space = *this;
  for (std::size_t k = 0; k < space.mesh_.knots.size(); ++k) space.mesh_.knots[k].position = positions[k];
  return space;
}

Vec2 SplineSpace::greville(FunctionIndex f) const {
  Vec2 sum;
  for (int i = 0; i < degree_; ++i) sum = sum + position(functions_[f].knots[static_cast<std::size_t>(i)]);
  return {sum.x / degree_, sum.y / degree_};
}

std::vector<Vec2> SplineSpace::geometry_greville() const {
  std::vector<Vec2> sites(geometry_count_);
  for (FunctionIndex f = 0; f < functions_.size(); ++f) sites[geometry_of_[f]] = greville(f);
  return sites;
}

std::vector<std::vector<std::array<CornerIndex, 3>>> function_triangles(const SplineSpace& space) {
  std::vector<FamilyConfig> family;
  family.reserve(space.configs().size());
  for (const Config& c : space.configs()) family.push_back({c.triangle, c.inner});
  std::vector<std::uint32_t> place(space.cut().corners.size(), kNotOnPath);
  std::vector<std::vector<std::array<CornerIndex, 3>>> result;
  const Triangulator triangulator = [](const LinkPolygon& polygon, std::vector<PolygonTriangle>& triangles) {
    triangles = triangulate_polygon(polygon.positions);
  };
  for_each_vertex(family, space.degree() - 1, [&](LinkVertex& vertex) {
    if (vertex.edges.empty()) return;
    auto triangles = link_triangles(space, vertex, space.degree() - 1, triangulator, place);
    std::erase_if(triangles, [&](const std::array<CornerIndex, 3>& t) {
      return signed_area(space.position(t[0]), space.position(t[1]), space.position(t[2])) == 0;
    });
    result.push_back(std::move(triangles));
  });
  return result;
}

}  // namespace knotreel::spline
