// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/idle_knots.h"

#include <algorithm>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/long_edges.h"

namespace knotreel::knots {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;

namespace {

/// Knots on the border hold the corners of faces that reach far into the picture, more than the linear
/// approximations tell: with their bare cost, cars that drive into the picture lose 0.2 dB.
constexpr double kBorderCost = 4;

bool may_go(mesh::KnotKind kind) {
  return kind == mesh::KnotKind::kFree || kind == mesh::KnotKind::kBorder;
}

struct IdleCandidate {
  double cost;
  KnotIndex knot;
};

/// Free and border knots by what they keep away, the idlest first.
std::vector<IdleCandidate> by_cost(const EditableMesh& mesh, const Target& target) {
  std::vector<double> errors(mesh.face_slots(), 0);
  std::vector<Moments> moments(mesh.face_slots());
  parallel_for(mesh.face_slots(), [&](std::size_t f) {
    if (!mesh.is_face(static_cast<FaceIndex>(f))) return;
    moments[f] = target.moments(mesh.triangle(static_cast<FaceIndex>(f)));
    errors[f] = target.fit(moments[f]).error;
  });
  std::vector<IdleCandidate> candidates;
  std::vector<FaceIndex> ring;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (!mesh.is_knot(k) || !may_go(mesh.knot(k).kind)) continue;
    mesh.faces_around(k, ring);
    Moments all;
    double apart = 0;
    for (const FaceIndex f : ring) {
      all = all + moments[f];
      apart += errors[f];
    }
    const double factor = mesh.knot(k).kind == mesh::KnotKind::kBorder ? kBorderCost : 1.0;
    candidates.push_back({factor * std::max(0.0, target.fit(all).error - apart), k});
  }
  std::sort(candidates.begin(), candidates.end(), [](const IdleCandidate& a, const IdleCandidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.knot < b.knot;
  });
  return candidates;
}

}  // namespace

std::vector<double> sorted_face_errors(const EditableMesh& mesh, std::span<const float> squared_errors,
                                       int width, int height) {
  std::vector<double> sums(mesh.face_slots(), 0);
  parallel_for(sums.size(), [&](std::size_t face) {
    const auto f = static_cast<FaceIndex>(face);
    if (!mesh.is_face(f)) return;
    const TriangleRows rows(mesh.triangle(f), width, height);
    double sum = 0;
    for (int y = rows.first(); y < rows.last(); ++y) {
      int begin = 0;
      int end = 0;
      rows.columns(y, begin, end);
      const float* row = squared_errors.data() + std::size_t(y) * std::size_t(width);
      for (int x = begin; x < end; ++x) sum += static_cast<double>(row[x]);
    }
    sums[f] = sum;
  });
  std::sort(sums.rbegin(), sums.rend());
  return sums;
}

std::size_t remove_idle_knots(EditableMesh& mesh, const Target& target, std::span<const double> face_errors,
                              const SwapOptions& options, std::size_t surplus) {
  const std::vector<IdleCandidate> candidates = by_cost(mesh, target);
  const auto most =
      std::max(surplus, static_cast<std::size_t>(options.share * static_cast<double>(mesh.knot_count())));
  std::vector<bool> touched(mesh.knot_slots(), false);  // costs around removed knots are out of date
  std::vector<FaceIndex> ring;
  std::size_t removed = 0;
  for (const IdleCandidate& c : candidates) {
    if (removed == most) break;
    if (removed >= surplus &&
        (removed >= face_errors.size() || 0.5 * face_errors[removed] <= options.ratio * c.cost))
      break;
    if (touched[c.knot]) continue;
    if (options.longest_edge > 0 && keeps_edges_short(mesh, c.knot, options.longest_edge)) continue;
    mesh.faces_around(c.knot, ring);
    for (const FaceIndex f : ring) {
      for (const KnotIndex k : mesh.face(f)) touched[k] = true;
    }
    if (mesh.remove(c.knot)) ++removed;
  }
  return removed;
}

}  // namespace knotreel::knots
