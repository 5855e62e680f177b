// SPDX-License-Identifier: GPL-3.0-or-later
#include "knots/connectivity.h"

#include <deque>
#include <limits>

#include "knotreel/base/parallel.h"
#include "knots/shape.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;

/// What the two faces at an edge would have as error if it were flipped.
class FlippedErrors {
 public:
  FlippedErrors(const EditableMesh& mesh, const Target& target, double least_angle)
      : mesh_(mesh),
        target_(target),
        least_sine_(sine_of_degrees(least_angle)),
        errors_(3 * mesh.face_slots(), kUnknown) {}

  double at(EditableMesh::Edge e) {
    if (errors_[place(e)] < 0) find(e);
    return errors_[place(e)];
  }

  /// Those of all edges of some faces at once. No face may be listed twice.
  void find_all(const std::vector<FaceIndex>& faces) {
    std::vector<bool> listed(mesh_.face_slots(), false);
    for (const FaceIndex f : faces) listed[f] = true;
    constexpr std::size_t kBlock = 64;
    parallel_for((faces.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(faces.size(), (block + 1) * kBlock); ++i) {
        const FaceIndex f = faces[i];
        for (int side = 0; side < 3; ++side) {
          const FaceIndex n = mesh_.neighbour(f, side);
          // One of the two faces at the edge finds it for both.
          if (n == mesh::kNoFace || !listed[n] || f < n) find({f, side});
        }
      }
    });
  }

  /// The face has changed.
  void forget(FaceIndex f) {
    for (int side = 0; side < 3; ++side) {
      errors_[place({f, side})] = kUnknown;
      if (mesh_.neighbour(f, side) != mesh::kNoFace) errors_[place(mesh_.mirror({f, side}))] = kUnknown;
    }
  }

 private:
  static constexpr double kUnknown = -1;
  static constexpr double kImpossible = std::numeric_limits<double>::infinity();

  static std::size_t place(EditableMesh::Edge e) { return 3 * std::size_t{e.face} + std::size_t(e.side); }

  void find(EditableMesh::Edge e) {
    const bool inner = mesh_.neighbour(e.face, e.side) != mesh::kNoFace;
    errors_[place(e)] = inner ? flipped(e) : kImpossible;
    if (inner) errors_[place(mesh_.mirror(e))] = errors_[place(e)];
  }

  double flipped(EditableMesh::Edge e) const {
    if (!mesh_.can_flip(e)) return kImpossible;
    const EditableMesh::Edge m = mesh_.mirror(e);
    const auto t = mesh_.triangle(e.face);
    const auto side = static_cast<std::size_t>(e.side);
    const Vec2 q = mesh_.position(mesh_.face(m.face)[static_cast<std::size_t>(m.side)]);
    const std::array<Vec2, 3> first{t[side], t[(side + 1) % 3], q};
    const std::array<Vec2, 3> second{t[side], q, t[(side + 2) % 3]};
    if (is_sliver(first, least_sine_) || is_sliver(second, least_sine_)) return kImpossible;
    return target_.error(first) + target_.error(second);
  }

  const EditableMesh& mesh_;
  const Target& target_;
  double least_sine_;
  std::vector<double> errors_;
};

std::vector<FaceIndex> with_neighbours(const EditableMesh& mesh, const std::vector<FaceIndex>& faces) {
  std::vector<bool> listed(mesh.face_slots(), false);
  for (const FaceIndex f : faces) listed[f] = true;
  std::vector<FaceIndex> all = faces;
  for (const FaceIndex f : faces) {
    for (int side = 0; side < 3; ++side) {
      const FaceIndex n = mesh.neighbour(f, side);
      if (n == mesh::kNoFace || listed[n]) continue;
      listed[n] = true;
      all.push_back(n);
    }
  }
  return all;
}

}  // namespace

std::size_t optimise_connectivity(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
                                  const std::vector<FaceIndex>& faces, FaceFits& fits) {
  FlippedErrors flipped(mesh, target, options.least_angle);
  fits.find(with_neighbours(mesh, faces));
  flipped.find_all(faces);
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
      const FaceIndex other = mesh.neighbour(f, i);
      if (other == mesh::kNoFace) continue;
      const double before = fits.at(f).error + fits.at(other).error;
      if (!(flipped.at({f, i}) < before * (1 - 1e-9))) continue;
      mesh.flip({f, i});
      ++flips;
      for (const FaceIndex g : {f, other}) {
        fits.forget(g);
        flipped.forget(g);
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

std::size_t optimise_connectivity(EditableMesh& mesh, const Target& target, const OptimiseOptions& options,
                                  const std::vector<FaceIndex>& faces) {
  FaceFits fits(mesh, target);
  return optimise_connectivity(mesh, target, options, faces, fits);
}

}  // namespace knotreel::knots
