#include "knotreel/knots/optimise.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "knotreel/base/parallel.h"
#include "knots/disc_walk.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;
using mesh::KnotKind;

std::size_t corner_of(const mesh::Face& face, KnotIndex k) {
  return face[0] == k ? 0 : face[1] == k ? 1 : 2;
}

double ring_energy(const EditableMesh& mesh, const Target& target, const std::vector<FaceIndex>& ring) {
  double sum = 0;
  for (const FaceIndex f : ring) sum += target.error(mesh.triangle(f));
  return sum;
}

/// Integral of (e_left - e_right) (1 - s) along the edge a -> b, s from 0 at a to 1 at b; samples about a
/// pixel apart. One side may be missing.
double edge_integral(const Target& target, Vec2 a, Vec2 b, const LinearFit* left, const LinearFit* right) {
  const double length = norm(b - a);
  const int samples = std::max(2, static_cast<int>(std::ceil(length)));
  double sum = 0;
  for (int i = 0; i < samples; ++i) {
    const double s = (i + 0.5) / samples;
    const Vec2 u = a + s * (b - a);
    const double difference =
        (left ? target.squared_error(*left, u) : 0.0) - (right ? target.squared_error(*right, u) : 0.0);
    sum += (1 - s) * difference;
  }
  return sum * length / samples;
}

Vec2 ring_gradient(const EditableMesh& mesh, const Target& target, KnotIndex k,
                   const std::vector<FaceIndex>& ring) {
  thread_local std::vector<LinearFit> fits;
  fits.clear();
  for (const FaceIndex f : ring) fits.push_back(target.fit(mesh.triangle(f)));
  const Vec2 from = mesh.position(k);
  const bool closed = mesh.knot(k).kind == KnotKind::kFree || mesh.knot(k).kind == KnotKind::kSegment;
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
    const KnotIndex j = v[(corner_of(v, k) + 1) % 3];
    const LinearFit* before = i > 0 ? &fits[i - 1] : closed ? &fits.back() : nullptr;
    add(j, &fits[i], before);
  }
  if (!closed) {
    const mesh::Face& v = mesh.face(ring.back());
    add(v[(corner_of(v, k) + 2) % 3], nullptr, &fits.back());
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

/// Height of a triangle over its longest side; with that side its thinness.
double height_over_longest(const std::array<Vec2, 3>& t) {
  const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  return 2 * signed_area(t[0], t[1], t[2]) / longest;
}

double angle_at(Vec2 p, Vec2 a, Vec2 b) {
  return std::atan2(std::abs(cross(a - p, b - p)), dot(a - p, b - p));
}

std::pair<double, double> extreme_angles(const std::array<Vec2, 3>& t) {
  const double a = angle_at(t[0], t[1], t[2]);
  const double b = angle_at(t[1], t[2], t[0]);
  const double c = angle_at(t[2], t[0], t[1]);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

bool is_sliver(const std::array<Vec2, 3>& t, double least_angle) {
  const auto [smallest, largest] = extreme_angles(t);
  const double limit = least_angle * std::numbers::pi / 180;
  return smallest < limit || largest > std::numbers::pi - limit;
}

/// Whether the knot keeps its distance from the features and the border at its faces.
bool keeps_distance(const EditableMesh& mesh, KnotIndex k, const std::vector<FaceIndex>& ring,
                    double distance) {
  if (mesh.knot(k).kind != KnotKind::kFree) return true;
  for (const FaceIndex f : ring) {
    const mesh::Face& v = mesh.face(f);
    const std::size_t i = corner_of(v, k);
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
                  double share) {
  thread_local std::vector<FaceIndex> ring;
  mesh.faces_around(knot, ring);
  const Vec2 old = mesh.position(knot);
  const Vec2 direction = mesh.projected(knot, old - ring_gradient(mesh, target, knot, ring)) - old;
  const double length = norm(direction);
  if (!(length > 1e-9)) return;
  const double before = ring_energy(mesh, target, ring);
  double step = share * shortest_edge(mesh, knot, ring);
  for (int attempt = 0; attempt < 3; ++attempt, step /= 2) {
    if (!mesh.move(knot, old + (step / length) * direction)) continue;
    if (well_shaped(mesh, knot, ring, options) && ring_energy(mesh, target, ring) < before) return;
    mesh.move(knot, old);
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
  return ring_gradient(mesh, target, knot, ring);
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

void descend_positions(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
                       const std::vector<std::vector<KnotIndex>>& classes, int k) {
  const double share = options.alpha * std::exp2(-static_cast<double>(k) / (options.steps - k));
  for (const std::vector<KnotIndex>& knots : classes) {
    // No two of them are neighbours, so their moves do not touch each other's faces.
    constexpr std::size_t kBlock = 32;
    parallel_for((knots.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(knots.size(), (block + 1) * kBlock); ++i) {
        descend_knot(mesh, target, options, knots[i], share);
      }
    });
  }
}

std::size_t optimise_connectivity(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
                                  const std::vector<FaceIndex>& faces) {
  std::deque<FaceIndex> open(faces.begin(), faces.end());
  std::vector<bool> queued(mesh.face_slots(), false);
  for (const FaceIndex f : faces) queued[f] = true;
  std::size_t flips = 0;
  const std::size_t most = 20 * faces.size() + 100;  // rounding could make a cycle
  while (!open.empty() && flips < most) {
    const FaceIndex f = open.front();
    open.pop_front();
    queued[f] = false;
    for (int i = 0; i < 3; ++i) {
      const EditableMesh::Edge e{f, i};
      if (!mesh.can_flip(e)) continue;
      const EditableMesh::Edge m = mesh.mirror(e);
      const Vec2 p = mesh.position(mesh.face(f)[static_cast<std::size_t>(i)]);
      const Vec2 a = mesh.position(mesh.face(f)[static_cast<std::size_t>((i + 1) % 3)]);
      const Vec2 b = mesh.position(mesh.face(f)[static_cast<std::size_t>((i + 2) % 3)]);
      const Vec2 q = mesh.position(mesh.face(m.face)[static_cast<std::size_t>(m.side)]);
      const std::array<Vec2, 3> first{p, a, q};
      const std::array<Vec2, 3> second{p, q, b};
      if (is_sliver(first, options.least_angle) || is_sliver(second, options.least_angle)) continue;
      const double before = target.error(mesh.triangle(f)) + target.error(mesh.triangle(m.face));
      const double after = target.error(first) + target.error(second);
      if (!(after < before * (1 - 1e-9))) continue;
      mesh.flip(e);
      ++flips;
      for (const FaceIndex g : {f, m.face}) {
        if (!queued[g]) open.push_back(g);
        queued[g] = true;
        for (int j = 0; j < 3; ++j) {
          const FaceIndex n = mesh.neighbour(g, j);
          if (n == mesh::kNoFace || queued[n]) continue;
          queued[n] = true;
          open.push_back(n);
        }
      }
      break;
    }
  }
  return flips;
}

std::size_t remove_slivers(EditableMesh& mesh, const Target& target, const OptimiseOptions& options) {
  std::size_t removed = 0;
  std::vector<FaceIndex> ring;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (!mesh.is_knot(k) || mesh.knot(k).kind != KnotKind::kFree) continue;
    mesh.faces_around(k, ring);
    bool bad = !far_from_lines(mesh, ring.front(), mesh.position(k), options.min_distance);
    for (const FaceIndex f : ring) {
      // The knot to blame is the one at the largest angle.
      const auto t = mesh.triangle(f);
      const std::size_t i = corner_of(mesh.face(f), k);
      const double own = angle_at(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
      const auto [smallest, largest] = extreme_angles(t);
      bad = bad || (is_sliver(t, options.least_angle) && own >= largest);
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
  std::vector<FaceIndex> ring;
  for (int round = 0; round < options.rounds; ++round) {
    if (options.positions) {
      const auto classes = independent_knots(mesh, knots);
      for (int k = 0; k < options.steps; ++k) descend_positions(mesh, target, options, classes, k);
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
      optimise_connectivity(mesh, target, options, faces);
    }
  }
}

}  // namespace knotreel::knots
