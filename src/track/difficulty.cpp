// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/difficulty.h"

#include "knotreel/knots/optimise.h"
#include "knotreel/knots/place.h"
#include "knotreel/mesh/triangulate.h"
#include "vectorize/first_knots.h"

namespace knotreel::track {

double difficulty(const knots::Target& target, const vectorize::Options& cold, std::size_t functions) {
  mesh::KnotMesh domain = mesh::make_domain(target.image().width, target.image().height);
  mesh::triangulate(domain);
  mesh::EditableMesh mesh(domain);
  knots::insert_knots(mesh, target, vectorize::first_knots(mesh, static_cast<double>(functions), cold));
  return knots::linear_energy(mesh, target);
}

}  // namespace knotreel::track
