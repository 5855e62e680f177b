// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/foresee.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/place.h"

namespace knotreel::track {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;

using Ids = std::array<std::uint32_t, 3>;

Ids ascending(Ids ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace

FaceErrors::FaceErrors(const mesh::KnotMesh& mesh, const knots::Target& target) : faces_(mesh.faces.size()) {
  parallel_for(faces_.size(), [&](std::size_t f) {
    const mesh::Face& v = mesh.faces[f];
    const auto id = [&](std::size_t i) { return static_cast<std::uint32_t>(mesh.knots[v[i]].id); };
    faces_[f] = {
        ascending({id(0), id(1), id(2)}),
        target.error({mesh.knots[v[0]].position, mesh.knots[v[1]].position, mesh.knots[v[2]].position})};
  });
  for (const Face& f : faces_) sum_ += f.error;
  std::sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) { return a.ids < b.ids; });
}

double FaceErrors::of(Ids ids) const {
  const Ids wanted = ascending(ids);
  const auto known = std::lower_bound(faces_.begin(), faces_.end(), wanted,
                                      [](const Face& f, const Ids& i) { return f.ids < i; });
  return known == faces_.end() || known->ids != wanted ? 0 : known->error;
}

Foresight::Foresight(const EditableMesh& mesh, const knots::Target& target, const FaceErrors& before)
    : error_before_(before.sum()) {
  std::vector<double> errors(mesh.face_slots(), 0);
  parallel_for(errors.size(), [&](std::size_t f) {
    if (mesh.is_face(static_cast<FaceIndex>(f)))
      errors[f] = target.error(mesh.triangle(static_cast<FaceIndex>(f)));
  });
  for (FaceIndex f = 0; f < errors.size(); ++f) {
    if (!mesh.is_face(f)) continue;
    error_now_ += errors[f];
    const mesh::Face& v = mesh.face(f);
    const auto id = [&](std::size_t i) { return static_cast<std::uint32_t>(mesh.knot(v[i]).id); };
    // A face that was not there before had no error.
    const double grown = errors[f] - before.of({id(0), id(1), id(2)});
    if (grown > 0) growths_.push_back({grown, f, v});
  }
  std::sort(growths_.begin(), growths_.end(), [](const Growth& a, const Growth& b) {
    return a.error != b.error ? a.error > b.error : a.face < b.face;
  });
}

double Foresight::loss() const {
  constexpr double kLeast = 1;  // squared levels, of the whole picture
  return 10 * std::log10((error_now_ + kLeast) / (error_before_ + kLeast));
}

std::vector<double> Foresight::growths() const {
  std::vector<double> result;
  for (const Growth& g : growths_) result.push_back(g.error);
  return result;
}

std::vector<KnotIndex> Foresight::insert(EditableMesh& mesh, std::size_t count, double min_distance) const {
  if (count == 0) return {};
  std::vector<KnotIndex> inserted;
  std::vector<bool> touched(mesh.face_slots(), false);
  std::vector<FaceIndex> ring;
  for (const Growth& g : growths_) {
    if (inserted.size() == count) break;
    if (touched[g.face] || !mesh.is_face(g.face) || mesh.face(g.face) != g.knots) continue;
    const auto [a, b, c] = mesh.triangle(g.face);
    const auto k = knots::insert_near(mesh, g.face, (1.0 / 3) * (a + b + c), min_distance);
    if (!k) continue;
    inserted.push_back(*k);
    touched.resize(mesh.face_slots(), true);
    mesh.faces_around(*k, ring);
    for (const FaceIndex f : ring) touched[f] = true;
  }
  for (const KnotIndex k : inserted) mesh.legalise_around(k);
  return inserted;
}

}  // namespace knotreel::track
