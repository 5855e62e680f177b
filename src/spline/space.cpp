// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/space.h"

#include <algorithm>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/link.h"
#include "spline/family.h"

namespace knotreel::spline {

namespace {

/// The loops of the links of all vertices of a family.
std::vector<LinkLoop> level_loops(const mesh::CutMesh& cut, const std::vector<FamilyConfig>& family,
                                  int level) {
  if (level == 0) return corner_loops(cut);
  std::vector<LinkLoop> loops;
  std::vector<std::uint32_t> place(cut.corners.size(), kNotOnPath);
  for_each_vertex(family, level, [&](LinkVertex& vertex) { append_loops(cut, vertex, level, place, loops); });
  return loops;
}

/// The loops that can be triangulated in more than one way.
class Polygons {
 public:
  Polygons(const SplineSpace& space, const std::vector<LinkLoop>& loops, int level) {
    for (const LinkLoop& loop : loops) {
      if (loop.fan) continue;
      for (const CornerIndex c : loop.corners) positions_.push_back(space.position(c));
    }
    std::size_t at = 0;
    for (const LinkLoop& loop : loops) {
      if (loop.fan) continue;
      const std::size_t n = loop.corners.size();
      polygons_.push_back({std::span(loop.vertex.data(), static_cast<std::size_t>(level) + 1),
                           std::span(loop.corners.data(), n), std::span(positions_).subspan(at, n)});
      at += n;
    }
  }

  std::span<const LinkPolygon> all() const { return polygons_; }

 private:
  std::vector<Vec2> positions_;
  std::vector<LinkPolygon> polygons_;
};

/// The family that the triangulations of links make.
/// @param codes from those of these loops on; those that were used are taken off.
/// @return nothing if they do not fit.
std::optional<std::vector<FamilyConfig>> next_family(const std::vector<LinkLoop>& loops,
                                                     std::span<const std::uint16_t>& codes) {
  std::size_t triangle_count = 0;
  for (const LinkLoop& loop : loops) triangle_count += loop.corners.size() - 2;
  std::vector<FamilyConfig> next;
  next.reserve(triangle_count);
  std::vector<std::array<CornerIndex, 3>> fan;
  std::vector<PolygonTriangle> triangles;
  for (const LinkLoop& loop : loops) {
    const std::array<CornerIndex, 2> inner{loop.vertex[0], loop.vertex[1]};
    if (loop.fan) {
      fan.clear();
      append_fan(loop, fan);
      for (const auto& t : fan) next.push_back({t, inner});
      continue;
    }
    triangles.clear();
    const auto used = decode_triangulation(loop.corners.size(), codes, triangles);
    if (!used) return std::nullopt;
    codes = codes.subspan(*used);
    for (const PolygonTriangle& t : triangles) {
      next.push_back({{loop.corners[t[0]], loop.corners[t[1]], loop.corners[t[2]]}, inner});
    }
  }
  return next;
}

}  // namespace

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

  /// Appends the codes of the links of one level, in the order of the polygons.
  using Chooser = std::function<void(std::span<const LinkPolygon>, std::vector<std::uint16_t>&)>;

  void run(const Chooser& choose) {
    std::vector<FamilyConfig> family = face_family(space_.cut_);
    for (int level = 0; level + 1 < space_.degree_; ++level) {
      const std::vector<LinkLoop> loops = level_loops(space_.cut_, family, level);
      const std::size_t from = space_.link_codes_.size();
      choose(Polygons(space_, loops, level).all(), space_.link_codes_);
      auto codes = std::span<const std::uint16_t>(space_.link_codes_).subspan(from);
      auto next = next_family(loops, codes);
      if (!next || !codes.empty()) {
        throw Error(ErrorKind::kInvalidArgument, "a link policy gave codes that do not fit its polygons");
      }
      family = std::move(*next);
    }
    finish(family);
  }

  /// The same with the codes of all levels.
  void run(std::span<const std::uint16_t> codes) {
    space_.link_codes_.assign(codes.begin(), codes.end());
    std::vector<FamilyConfig> family = face_family(space_.cut_);
    for (int level = 0; level + 1 < space_.degree_; ++level) {
      auto next = next_family(level_loops(space_.cut_, family, level), codes);
      if (!next) throw Error(ErrorKind::kInput, "the link codes do not fit the knot mesh");
      family = std::move(*next);
    }
    if (!codes.empty()) throw Error(ErrorKind::kInput, "more link codes than the knot mesh has links");
    finish(family);
  }

 private:
  void finish(const std::vector<FamilyConfig>& family) {
    name_functions(family);
    group_by_geometry();
  }

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
      std::array<mesh::KnotIndex, 3> knots;  ///< ascending, because corners are numbered by knot
      FunctionIndex function;
    };
    std::vector<Keyed> keyed(space_.functions_.size());
    for (FunctionIndex f = 0; f < keyed.size(); ++f) {
      keyed[f].function = f;
      for (std::size_t i = 0; i < 3; ++i) {
        const CornerIndex c = space_.functions_[f].knots[i];
        keyed[f].knots[i] = c == kNoCorner ? kNoCorner : space_.cut_.corners[c].knot;
      }
    }
    // Functions are in the order of their first corners, so of their first knots.
    for (auto first = keyed.begin(); first != keyed.end();) {
      const auto last =
          std::find_if(first, keyed.end(), [&](const Keyed& k) { return k.knots[0] != first->knots[0]; });
      std::sort(first, last, [](const Keyed& a, const Keyed& b) {
        if (a.knots[1] != b.knots[1]) return a.knots[1] < b.knots[1];
        if (a.knots[2] != b.knots[2]) return a.knots[2] < b.knots[2];
        return a.function < b.function;
      });
      first = last;
    }
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
    : SplineSpace(std::move(mesh), degree, delaunay_policy, LinkOrder::kAny) {}

SplineSpace::SplineSpace(mesh::KnotMesh mesh, int degree, const LinkPolicy& policy, LinkOrder order) {
  require_sound(mesh::find_defect(mesh), ErrorKind::kInvalidArgument);
  SpaceBuilder builder(*this, std::move(mesh), degree);
  builder.run([&](std::span<const LinkPolygon> polygons, std::vector<std::uint16_t>& codes) {
    if (order == LinkOrder::kFixed) {
      for (const LinkPolygon& polygon : polygons) policy(polygon, codes);
      return;
    }
    constexpr std::size_t kBlock = 64;
    std::vector<std::vector<std::uint16_t>> parts((polygons.size() + kBlock - 1) / kBlock);
    parallel_for(parts.size(), [&](std::size_t block) {
      for (const LinkPolygon& polygon :
           polygons.subspan(block * kBlock, std::min(kBlock, polygons.size() - block * kBlock))) {
        policy(polygon, parts[block]);
      }
    });
    for (const auto& part : parts) codes.insert(codes.end(), part.begin(), part.end());
  });
}

SplineSpace SplineSpace::from_link_codes(mesh::KnotMesh mesh, int degree,
                                         std::span<const std::uint16_t> codes) {
  require_sound(mesh::find_topological_defect(mesh), ErrorKind::kInput);
  SplineSpace space;
  SpaceBuilder(space, std::move(mesh), degree).run(codes);
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

void for_each_link(const SplineSpace& space, const LinkVisitor& visit) {
  std::span<const std::uint16_t> codes = space.link_codes();
  std::vector<FamilyConfig> family = face_family(space.cut());
  std::vector<PolygonTriangle> triangles;
  for (int level = 0; level + 1 < space.degree(); ++level) {
    const std::vector<LinkLoop> loops = level_loops(space.cut(), family, level);
    std::span<const std::uint16_t> of_level = codes;
    const Polygons polygons(space, loops, level);
    for (const LinkPolygon& polygon : polygons.all()) {
      triangles.clear();
      const std::size_t used = decode_triangulation(polygon.corners.size(), codes, triangles).value();
      visit(polygon, codes.first(used), triangles);
      codes = codes.subspan(used);
    }
    if (level + 2 < space.degree()) family = next_family(loops, of_level).value();
  }
}

std::vector<std::vector<std::array<CornerIndex, 3>>> function_triangles(const SplineSpace& space) {
  std::vector<FamilyConfig> family;
  family.reserve(space.configs().size());
  for (const Config& c : space.configs()) family.push_back({c.triangle, c.inner});
  std::vector<std::uint32_t> place(space.cut().corners.size(), kNotOnPath);
  std::vector<std::vector<std::array<CornerIndex, 3>>> result;
  std::vector<LinkLoop> loops;
  std::vector<Vec2> positions;
  for_each_vertex(family, space.degree() - 1, [&](LinkVertex& vertex) {
    if (vertex.edges.empty()) return;
    loops.clear();
    append_loops(space.cut(), vertex, space.degree() - 1, place, loops);
    std::vector<std::array<CornerIndex, 3>> triangles;
    for (const LinkLoop& loop : loops) {
      if (loop.fan) {
        append_fan(loop, triangles);
        continue;
      }
      positions.clear();
      for (const CornerIndex c : loop.corners) positions.push_back(space.position(c));
      for (const PolygonTriangle& t : triangulate_polygon(positions)) {
        triangles.push_back({loop.corners[t[0]], loop.corners[t[1]], loop.corners[t[2]]});
      }
    }
    std::erase_if(triangles, [&](const std::array<CornerIndex, 3>& t) {
      return signed_area(space.position(t[0]), space.position(t[1]), space.position(t[2])) == 0;
    });
    result.push_back(std::move(triangles));
  });
  return result;
}

}  // namespace knotreel::spline
