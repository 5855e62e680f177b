// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/optimise.h"

#include <algorithm>
#include <cmath>

#include "base/triangle.h"
#include "knotreel/base/parallel.h"
#include "knots/connectivity.h"
#include "knots/disc_walk.h"
#include "knots/face_fits.h"
#include "knots/shape.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr double kSpacing = 2;  // of samples along edges, pixels: half of the time of one, and as good

/// Calls visit(point, s) at the places where an edge a -> b is sampled, s from 0 at a to 1 at b.
/// @return how many there are.
template <class Visit>
[[gnu::always_inline]] inline int for_samples(Vec2 a, Vec2 b, double length, Visit&& visit) {
  const int samples = std::max(2, static_cast<int>(std::ceil(length / kSpacing)));
  for (int i = 0; i < samples; ++i) {
    const double s = (i + 0.5) / samples;
    visit(a + s * (b - a), s);
  }
  return samples;
}

/// @param channels of the picture.
[[gnu::always_inline]] inline double integral_along(const Target& target, Vec2 a, Vec2 b,
                                                    const LinearFit* left, const LinearFit* right,
                                                    std::size_t channels) {
  const double length = norm(b - a);
  double sum = 0;
  const int samples = for_samples(a, b, length, [&](Vec2 u, double s) {
    const std::array<double, 4> colour = target.colour(u, channels);
    const double difference = (left ? Target::squared_error(*left, u, colour, channels) : 0.0) -
                              (right ? Target::squared_error(*right, u, colour, channels) : 0.0);
    sum += (1 - s) * difference;
  });
  return sum * length / samples;
}

/// Integral of (e_left - e_right) (1 - s) along the edge a -> b, s from 0 at a to 1 at b; samples about
/// kSpacing apart. One side may be missing.
double edge_integral(const Target& target, Vec2 a, Vec2 b, const LinearFit* left, const LinearFit* right) {
  if (target.channels() == 3) return integral_along(target, a, b, left, right, 3);
  return integral_along(target, a, b, left, right, static_cast<std::size_t>(target.channels()));
}

/// Asks for the colours along the edges of a knot, most of the time of whose integrals is waiting for memory.
void prefetch_edges(const EditableMesh& mesh, const Target& target, KnotIndex k,
                    const std::vector<FaceIndex>& ring) {
  const Vec2 from = mesh.position(k);
  const auto channels = static_cast<std::size_t>(target.channels());
  for (const FaceIndex f : ring) {
    const mesh::Face& v = mesh.face(f);
    const Vec2 to = mesh.position(v[(mesh.corner_of(f, k) + 1) % 3]);
    for_samples(from, to, norm(to - from), [&](Vec2 u, double) { target.prefetch_colour(u, channels); });
  }
}

Vec2 ring_gradient(const EditableMesh& mesh, const Target& target, KnotIndex k,
                   const std::vector<FaceIndex>& ring, FaceFits& fits) {
  const Vec2 from = mesh.position(k);
  const bool closed = mesh.knot(k).kind == KnotKind::kFree || mesh.knot(k).kind == KnotKind::kSegment;
  prefetch_edges(mesh, target, k, ring);
  Vec2 gradient;
  const auto add = [&](KnotIndex j, const LinearFit* left, const LinearFit* right) {
    const Vec2 d = mesh.position(j) - from;
    const double length = norm(d);
    const double integral = edge_integral(target, from, mesh.position(j), left, right);
    gradient = gradient + (integral / length) * Vec2{d.y, -d.x};
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    // The first edge of face i, from the knot: face i is on its left, the face before on its right.
    const mesh::Face& v = mesh.face(ring[i]);
    const KnotIndex j = v[(mesh.corner_of(ring[i], k) + 1) % 3];
    const LinearFit* before = i > 0 ? &fits.at(ring[i - 1]) : closed ? &fits.at(ring.back()) : nullptr;
    add(j, &fits.at(ring[i]), before);
  }
  if (!closed) {
    const mesh::Face& v = mesh.face(ring.back());
    add(v[(mesh.corner_of(ring.back(), k) + 2) % 3], nullptr, &fits.at(ring.back()));
  }
  return gradient;
}

double shortest_edge(const EditableMesh& mesh, KnotIndex k, const std::vector<FaceIndex>& ring) {
  double shortest = 1e300;
  for (const FaceIndex f : ring) {
    for (const KnotIndex j : mesh.face(f)) {
      if (j != k) shortest = std::min(shortest, norm(mesh.position(j) - mesh.position(k)));
    }
  }
  return shortest;
}

/// Whether the knot keeps its distance from the features and the border at its faces.
bool keeps_distance(const EditableMesh& mesh, KnotIndex k, const std::vector<FaceIndex>& ring,
                    double distance) {
  if (mesh.knot(k).kind != KnotKind::kFree) return true;
  for (const FaceIndex f : ring) {
    const mesh::Face& v = mesh.face(f);
    const std::size_t i = mesh.corner_of(f, k);
    if (!mesh.is_fixed({f, static_cast<int>(i)})) continue;
    const Vec2 a = mesh.position(v[(i + 1) % 3]);
    const Vec2 b = mesh.position(v[(i + 2) % 3]);
    if (2 * signed_area(a, b, mesh.position(k)) < distance * norm(b - a)) return false;
  }
  return true;
}

/// Faces as good as they were: no new sliver, and not nearer than allowed to knots and features.
bool well_shaped(const EditableMesh& mesh, KnotIndex k, const std::vector<FaceIndex>& ring,
                 const OptimiseOptions& options) {
  for (const FaceIndex f : ring) {
    if (height_over_longest(mesh.triangle(f)) < 0.25 * options.min_distance) return false;
  }
  return shortest_edge(mesh, k, ring) >= options.min_distance &&
         keeps_distance(mesh, k, ring, options.min_distance);
}

/// One step of Eq. 9 for one knot, halved while it would flip a face or raise the energy.
void descend_knot(EditableMesh& mesh, const Target& target, const OptimiseOptions& options, KnotIndex knot,
                  double share, FaceFits& fits) {
  thread_local std::vector<FaceIndex> ring;
  thread_local std::vector<LinearFit> moved;
  mesh.faces_around(knot, ring);
  const Vec2 old = mesh.position(knot);
  const Vec2 direction = mesh.projected(knot, old - ring_gradient(mesh, target, knot, ring, fits)) - old;
  const double length = norm(direction);
  if (!(length > 1e-9)) return;
  double before = 0;
  for (const FaceIndex f : ring) before += fits.at(f).error;
  double step = share * shortest_edge(mesh, knot, ring);
  for (int attempt = 0; attempt < 3; ++attempt, step /= 2) {
    if (!mesh.move(knot, old + (step / length) * direction)) continue;
    if (well_shaped(mesh, knot, ring, options)) {
      moved.clear();
      double energy = 0;
      for (std::size_t i = 0; i < ring.size() && energy < before; ++i) {
        moved.push_back(target.fit(mesh.triangle(ring[i])));
        energy += moved.back().error;
      }
      if (energy < before) {
        for (std::size_t i = 0; i < ring.size(); ++i) fits.set(ring[i], moved[i]);
        return;
      }
    }
    mesh.move(knot, old);
  }
}

/// One sweep over classes of independent knots.
void sweep(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
           const std::vector<std::vector<KnotIndex>>& classes, int k, FaceFits& fits) {
  const double share = options.alpha * std::exp2(-static_cast<double>(k) / (options.steps - k));
  for (const std::vector<KnotIndex>& knots : classes) {
    // No two of them are neighbours, so their moves do not touch each other's faces.
    constexpr std::size_t kBlock = 8;
    parallel_for((knots.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(knots.size(), (block + 1) * kBlock); ++i) {
        descend_knot(mesh, target, options, knots[i], share, fits);
      }
    });
  }
}

}  // namespace

double linear_energy(const EditableMesh& mesh, const Target& target) {
  double sum = 0;
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (mesh.is_face(f)) sum += target.error(mesh.triangle(f));
  }
  return sum;
}

Vec2 energy_gradient(const EditableMesh& mesh, const Target& target, KnotIndex knot) {
  std::vector<FaceIndex> ring;
  mesh.faces_around(knot, ring);
  FaceFits fits(mesh, target);
  return ring_gradient(mesh, target, knot, ring, fits);
}

std::vector<std::vector<KnotIndex>> independent_knots(const EditableMesh& mesh,
                                                      const std::vector<KnotIndex>& knots) {
  std::vector<int> colour(mesh.knot_slots(), -1);
  std::vector<std::vector<KnotIndex>> classes;
  std::vector<FaceIndex> ring;
  for (const KnotIndex k : knots) {
    if (mesh.knot(k).kind == KnotKind::kVertex) continue;
    mesh.faces_around(k, ring);
    std::uint64_t taken = 0;
    for (const FaceIndex f : ring) {
      for (const KnotIndex j : mesh.face(f)) {
        if (colour[j] >= 0) taken |= std::uint64_t{1} << std::min(63, colour[j]);
      }
    }
    int c = 0;
    while (c < 63 && (taken >> c & 1) != 0) ++c;
    if (c == 63) continue;  // such a crowd of neighbours has no place to go anyway
    colour[k] = c;
    if (classes.size() <= static_cast<std::size_t>(c)) classes.emplace_back();
    classes[static_cast<std::size_t>(c)].push_back(k);
  }
  return classes;
}

std::size_t remove_slivers(EditableMesh& mesh, const Target& target, const OptimiseOptions& options) {
  std::size_t removed = 0;
  const double least_sine = sine_of_degrees(options.least_angle);
  std::vector<FaceIndex> ring;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (!mesh.is_knot(k) || mesh.knot(k).kind != KnotKind::kFree) continue;
    mesh.faces_around(k, ring);
    bool bad = !far_from_lines(mesh, ring.front(), mesh.position(k), options.min_distance);
    for (const FaceIndex f : ring) {
      const auto t = mesh.triangle(f);
      // The knot to blame is the one at the largest angle.
      bad = bad || (is_sliver(t, least_sine) && mesh.corner_of(f, k) == widest_corner(t));
    }
    if (!bad) continue;
    if (mesh.remove(k)) ++removed;
  }
  if (removed > 0) {
    std::vector<FaceIndex> faces;
    for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
      if (mesh.is_face(f)) faces.push_back(f);
    }
    optimise_connectivity(mesh, target, options, faces);
  }
  return removed;
}

void optimise(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
              const std::vector<bool>& active) {
  std::vector<KnotIndex> knots;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (mesh.is_knot(k) && (active.empty() || (k < active.size() && active[k]))) knots.push_back(k);
  }
  FaceFits fits(mesh, target);
  std::vector<FaceIndex> ring;
  for (int round = 0; round < options.rounds; ++round) {
    if (options.positions) {
      const auto classes = independent_knots(mesh, knots);
      for (int k = 0; k < options.steps; ++k) sweep(mesh, target, options, classes, k, fits);
    }
    if (options.connectivity) {
      std::vector<bool> seen(mesh.face_slots(), false);
      std::vector<FaceIndex> faces;
      for (const KnotIndex k : knots) {
        mesh.faces_around(k, ring);
        for (const FaceIndex f : ring) {
          if (!seen[f]) faces.push_back(f);
          seen[f] = true;
        }
      }
      optimise_connectivity(mesh, target, options, faces, fits);
    }
  }
}

}  // namespace knotreel::knots
