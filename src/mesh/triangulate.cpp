// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"

namespace knotreel::mesh {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<KnotIndex, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Cdt =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;

/// Knots in a snake through square cells, so that the point location of each insertion starts near by.
std::vector<KnotIndex> insertion_order(const KnotMesh& mesh) {
  const double cell = std::sqrt(mesh.width * mesh.height / static_cast<double>(mesh.knots.size())) * 2;
  struct Place {
    long row;
    double along;
    KnotIndex knot;
  };
  std::vector<Place> places;
  places.reserve(mesh.knots.size());
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    const Vec2 p = mesh.knots[k].position;
    const long row = std::lround(std::floor(p.y / cell));
    places.push_back({row, row % 2 == 0 ? p.x : -p.x, k});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    if (a.row != b.row) return a.row < b.row;
    return a.along != b.along ? a.along < b.along : a.knot < b.knot;
  });
  std::vector<KnotIndex> order;
  for (const Place& p : places) order.push_back(p.knot);
  return order;
}

std::vector<Face> sorted_faces(const Cdt& cdt) {
  std::vector<Face> faces;
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) {
    Face face{f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace

void triangulate(KnotMesh& mesh) {
  for (const Knot& k : mesh.knots) {
    if (!std::isfinite(k.position.x) || !std::isfinite(k.position.y)) {
      throw Error(ErrorKind::kInvalidArgument, "cannot triangulate: a knot has no finite position");
    }
  }
  for (const FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 0; i < s.knots.size(); ++i) {
      if (s.knots[i] >= mesh.knots.size()) {
        throw Error(ErrorKind::kInvalidArgument,
                    "cannot triangulate: a segment refers to a knot that does not exist");
      }
      if (i > 0 && s.knots[i] == s.knots[i - 1]) {
        throw Error(ErrorKind::kInvalidArgument,
                    "cannot triangulate: a segment has the same knot twice in a row");
      }
    }
  }
  Cdt cdt;
  std::vector<Cdt::Vertex_handle> vertices(mesh.knots.size());
  Cdt::Face_handle hint;
  for (const KnotIndex k : insertion_order(mesh)) {
    const Vec2 p = mesh.knots[k].position;
    vertices[k] = cdt.insert(Kernel::Point_2(p.x, p.y), hint);
    vertices[k]->info() = k;
    hint = vertices[k]->face();
  }
  if (cdt.number_of_vertices() != mesh.knots.size()) {
    throw Error(ErrorKind::kInvalidArgument, "cannot triangulate: two knots coincide");
  }
  try {
    for (const FeatureSegment& s : mesh.segments) {
      for (std::size_t i = 1; i < s.knots.size(); ++i) {
        cdt.insert_constraint(vertices[s.knots[i - 1]], vertices[s.knots[i]]);
      }
    }
  } catch (const Cdt::Intersection_of_constraints_exception&) {
    throw Error(ErrorKind::kInvalidArgument, "cannot triangulate: feature segments cross");
  }
  mesh.faces = sorted_faces(cdt);
  if (const auto defect = find_defect(mesh)) {
    throw Error(ErrorKind::kInvalidArgument, "cannot triangulate: " + *defect);
  }
}

KnotMesh make_domain(double width, double height) {
  KnotMesh mesh;
  mesh.width = width;
  mesh.height = height;
  const Vec2 corners[] = {{0, 0}, {width, 0}, {width, height}, {0, height}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh.knots.push_back({corners[i], KnotKind::kVertex, KnotId{i}});
  }
  return mesh;
}

}  // namespace knotreel::mesh
