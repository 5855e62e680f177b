#include "knotreel/spline/space.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
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

  /// Appends the codes of the links of one level, in the order of the polygons.
  using Chooser = std::function<void(std::span<const LinkPolygon>, std::vector<std::uint16_t>&)>;

  /// @param misfit what to say of codes that do not fit the links.
  void run(const Chooser& choose, const Error& misfit) {
    std::vector<FamilyConfig> family = face_family(space_.cut_);
    std::vector<std::uint32_t> place(space_.cut_.corners.size(), kNotOnPath);
    for (int level = 0; level + 1 < space_.degree_; ++level) {
      std::vector<LinkLoop> loops;
      for_each_vertex(family, level,
                      [&](LinkVertex& vertex) { append_loops(space_.cut_, vertex, level, place, loops); });
      const std::size_t from = space_.link_codes_.size();
      choose_links(loops, level, choose);
      family = next_family(loops, std::span(space_.link_codes_).subspan(from), misfit);
    }
    name_functions(family);
    group_by_geometry();
  }

 private:
  void choose_links(const std::vector<LinkLoop>& loops, int level, const Chooser& choose) {
    std::vector<Vec2> positions;
    for (const LinkLoop& loop : loops) {
      if (loop.fan) continue;
      for (const CornerIndex c : loop.corners) positions.push_back(space_.position(c));
    }
    std::vector<LinkPolygon> polygons;
    std::size_t at = 0;
    for (const LinkLoop& loop : loops) {
      if (loop.fan) continue;
      const std::size_t n = loop.corners.size();
      polygons.push_back({std::span(loop.vertex.data(), static_cast<std::size_t>(level) + 1), loop.corners,
                          std::span(positions).subspan(at, n)});
      at += n;
    }
    choose(polygons, space_.link_codes_);
  }

  static std::vector<FamilyConfig> next_family(const std::vector<LinkLoop>& loops,
                                               std::span<const std::uint16_t> codes, const Error& misfit) {
    std::vector<FamilyConfig> next;
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
      if (!used) throw misfit;
      codes = codes.subspan(*used);
      for (const PolygonTriangle& t : triangles) {
        next.push_back({{loop.corners[t[0]], loop.corners[t[1]], loop.corners[t[2]]}, inner});
      }
    }
    if (!codes.empty()) throw misfit;
    return next;
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
    : SplineSpace(std::move(mesh), degree, delaunay_policy, LinkOrder::kAny) {}

SplineSpace::SplineSpace(mesh::KnotMesh mesh, int degree, const LinkPolicy& policy, LinkOrder order) {
  require_sound(mesh::find_defect(mesh), ErrorKind::kInvalidArgument);
  SpaceBuilder builder(*this, std::move(mesh), degree);
  builder.run(
      [&](std::span<const LinkPolygon> polygons, std::vector<std::uint16_t>& codes) {
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
      },
      {ErrorKind::kInvalidArgument, "a link policy gave codes that do not fit its polygons"});
}

SplineSpace SplineSpace::from_link_codes(mesh::KnotMesh mesh, int degree,
                                         std::span<const std::uint16_t> codes) {
  require_sound(mesh::find_topological_defect(mesh), ErrorKind::kInput);
  SplineSpace space;
  SpaceBuilder builder(space, std::move(mesh), degree);
  const Error misfit(ErrorKind::kInput, "the link codes do not fit the knot mesh");
  builder.run(
      [&](std::span<const LinkPolygon> polygons, std::vector<std::uint16_t>& taken) {
        std::size_t count = 0;
        std::vector<PolygonTriangle> triangles;
        for (const LinkPolygon& polygon : polygons) {
          const auto used = decode_triangulation(polygon.corners.size(), codes.subspan(count), triangles);
          if (!used) throw misfit;
          count += *used;
          triangles.clear();
        }
        taken.insert(taken.end(), codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(count));
        codes = codes.subspan(count);
      },
      misfit);
  if (!codes.empty()) throw Error(ErrorKind::kInput, "more link codes than the knot mesh has links");
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
