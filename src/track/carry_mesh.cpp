// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/carry_mesh.h"

#include <algorithm>
#include <utility>

#include "base/triangle.h"

namespace knotreel::track {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

namespace {

constexpr int kSlowings = 4;         // of a knot, before it rests
constexpr double kStuck = 0.5;       // from where the end of a segment should be, pixels
constexpr double kLeastGain = 1e-3;  // of a flip for the flatter of two faces, pixels
constexpr double kThinnest = 0.05;   // height of faces between features, which no removal can mend; pixels

/// Segments without a knot inside that nothing else holds on to any more are no sound ones (mesh::KnotMesh).
void give_up_bare(const KnotMesh& mesh, std::vector<bool>& given_up) {
  std::vector<int> ends_at(mesh.knots.size(), 0);
  for (std::size_t i = 0; i < given_up.size(); ++i) {
    if (given_up[i]) continue;
    ++ends_at[mesh.segments[i].knots.front()];
    ++ends_at[mesh.segments[i].knots.back()];
  }
  for (std::size_t i = 0; i < given_up.size(); ++i) {
    const auto& knots = mesh.segments[i].knots;
    const auto is_tip = [&](KnotIndex k) {
      return ends_at[k] == 1 && !on_side(mesh, mesh.knots[k].position);
    };
    if (knots.size() == 2 && is_tip(knots.front()) && is_tip(knots.back())) given_up[i] = true;
  }
}

/// Gives segments up whose ends cannot stay inside the domain; their knots become free where nothing else
/// holds them.
/// @param kept_indices of the segments that are left, in order.
KnotMesh without_leaving_segments(const KnotMesh& mesh, std::span<const Vec2> targets,
                                  std::span<const std::uint8_t> lost,
                                  std::vector<std::size_t>& kept_indices) {
  const auto leaves = [&](KnotIndex k) {
    const Vec2 p = mesh.knots[k].position;
    const Vec2 t = targets[k];
    const auto axis = [](double before, double now, double size) {
      if (before == 0 || before == size) return now != before;  // slides along another side
      return now != before && (now < 1 || now > size - 1);
    };
    return axis(p.x, t.x, mesh.width) || axis(p.y, t.y, mesh.height);
  };
  std::vector<bool> given_up(mesh.segments.size());
  for (std::size_t i = 0; i < given_up.size(); ++i) {
    const auto& knots = mesh.segments[i].knots;
    given_up[i] = (!lost.empty() && lost[i]) || leaves(knots.front()) || leaves(knots.back());
  }
  give_up_bare(mesh, given_up);
  KnotMesh result = mesh;
  result.segments.clear();
  for (std::size_t i = 0; i < given_up.size(); ++i) {
    if (given_up[i]) continue;
    result.segments.push_back(mesh.segments[i]);
    kept_indices.push_back(i);
  }
  if (result.segments.size() == mesh.segments.size()) return result;
  std::vector<bool> held(mesh.knots.size(), false);
  for (const mesh::FeatureSegment& s : result.segments) {
    for (const KnotIndex k : s.knots) held[k] = true;
  }
  for (KnotIndex k = 0; k < held.size(); ++k) {
    mesh::Knot& knot = result.knots[k];
    const bool x_side = knot.position.x == 0 || knot.position.x == mesh.width;
    const bool y_side = knot.position.y == 0 || knot.position.y == mesh.height;
    if (held[k] || knot.kind == KnotKind::kFree || (x_side && y_side)) continue;
    knot.kind = x_side || y_side ? KnotKind::kBorder : KnotKind::kFree;
  }
  return result;
}

class Carrier {
 public:
  Carrier(const KnotMesh& mesh, std::vector<Vec2> targets, const CarryOptions& options, CarryReport& report)
      : mesh_(mesh),
        targets_(targets),
        wanted_(std::move(targets)),
        least_(0.25 * options.min_distance),
        report_(report) {}

  KnotMesh run() {
    remove_leaving();
    mend();
    hold_rest();
    return moved();
  }

  /// After run().
  bool is_stuck(const mesh::FeatureSegment& s) const {
    const auto far = [&](KnotIndex k) { return norm(targets_[k] - wanted_[k]) >= kStuck; };
    return far(s.knots.front()) || far(s.knots.back());
  }

 private:
  double height(const mesh::Face& v, bool after) const {
    const auto at = [&](KnotIndex k) { return after ? targets_[k] : mesh_.position(k); };
    return height_over_longest({at(v[0]), at(v[1]), at(v[2])});
  }

  /// Whether a face may be mended by taking its i-th knot away. Two others that are too close go on being so:
  /// one knot after the other would be taken away around them.
  bool is_of_use(const mesh::Face& v, std::size_t i) const {
    return mesh_.knot(v[i]).kind == KnotKind::kFree &&
           norm(targets_[v[(i + 1) % 3]] - targets_[v[(i + 2) % 3]]) >= least_;
  }

  /// Too flat after the move; what is flatter already may stay as it is.
  bool is_bad(const mesh::Face& v) const {
    const double after = height(v, true);
    if (after >= least_) return false;
    const bool mendable = is_of_use(v, 0) || is_of_use(v, 1) || is_of_use(v, 2);
    if (!mendable && after >= kThinnest) return false;
    const bool still =
        std::all_of(v.begin(), v.end(), [&](KnotIndex k) { return targets_[k] == mesh_.position(k); });
    return !still && (after <= 0.02 || after < 0.999 * height(v, false));
  }
  bool is_bad(FaceIndex f) const { return mesh_.is_face(f) && is_bad(mesh_.face(f)); }

  std::vector<FaceIndex> bad_faces() const {
    std::vector<FaceIndex> bad;
    for (FaceIndex f = 0; f < mesh_.face_slots(); ++f) {
      if (is_bad(f)) bad.push_back(f);
    }
    return bad;
  }

  void remove_leaving() {
    for (KnotIndex k = 0; k < targets_.size(); ++k) {
      const Vec2 t = targets_[k];
      const bool inside = t.x >= 1 && t.y >= 1 && t.x <= mesh_.width() - 1 && t.y <= mesh_.height() - 1;
      if (mesh_.knot(k).kind != KnotKind::kFree || inside || t == mesh_.position(k)) continue;
      if (mesh_.remove(k)) {
        ++report_.removed;
      } else {
        targets_[k] = mesh_.position(k);
        ++report_.held;
      }
    }
  }

  /// Mends faces until none is bad, or none can be mended. To go on to the end matters: next to a knot that
  /// has to stay, all others have to, as far as the picture moves. It does end, since a flip leaves two sound
  /// faces or makes the flatter of two less flat, anything else takes a knot away, and what is tried in vain
  /// changes nothing.
  void mend() {
    std::vector<FaceIndex> bad = bad_faces();
    for (bool any = true; any && !bad.empty();) {
      any = false;
      std::vector<FaceIndex> next;
      for (const FaceIndex f : bad) {
        if (!is_bad(f)) continue;
        if (flip_away(f) || remove_from(f, next) || flip_for_better(f)) {
          any = true;
        } else {
          next.push_back(f);
        }
      }
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      std::erase_if(next, [&](FaceIndex f) { return !is_bad(f); });
      bad = std::move(next);
    }
  }

  /// Flips an edge of a face if both faces are sound after it, now and after the move.
  bool flip_away(FaceIndex f) {
    return flip(f, [&](double flattest, double) { return flattest >= least_; });
  }

  /// Between features that pass each other there may be no knot to take away, and no flip that leaves sound
  /// faces; each step counts then, lest the features be held until they are given up.
  bool flip_for_better(FaceIndex f) {
    return flip(f, [](double flattest, double before) {
      return flattest >= kThinnest && flattest > before + kLeastGain;
    });
  }

  /// Flips the first edge of a face for which is_good(height of the flatter face behind it, and before it),
  /// both after the move.
  template <class IsGood>
  bool flip(FaceIndex f, IsGood&& is_good) {
    for (int side = 0; side < 3; ++side) {
      const EditableMesh::Edge e{f, side};
      if (!mesh_.can_flip(e)) continue;
      const EditableMesh::Edge m = mesh_.mirror(e);
      const auto i = static_cast<std::size_t>(side);
      const mesh::Face& v = mesh_.face(f);
      const KnotIndex q = mesh_.face(m.face)[static_cast<std::size_t>(m.side)];
      const mesh::Face first{v[i], v[(i + 1) % 3], q};
      const mesh::Face second{v[i], q, v[(i + 2) % 3]};
      const double before = std::min(height(v, true), height(mesh_.face(m.face), true));
      if (!is_good(std::min(height(first, true), height(second, true)), before)) continue;
      mesh_.flip(e);
      ++report_.flips;
      return true;
    }
    return false;
  }

  /// Takes away a free knot of a face: that which moves least like its neighbours, if it can be removed.
  /// @param touched gets the faces that take its place, and maybe others.
  bool remove_from(FaceIndex f, std::vector<FaceIndex>& touched) {
    std::vector<std::pair<double, KnotIndex>> candidates;
    const mesh::Face& v = mesh_.face(f);
    for (std::size_t i = 0; i < 3; ++i) {
      if (is_of_use(v, i)) candidates.emplace_back(-deviation(v[i]), v[i]);
    }
    std::sort(candidates.begin(), candidates.end());
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](const auto& candidate) { return remove(candidate.second, touched); });
  }

  bool remove(KnotIndex k, std::vector<FaceIndex>& touched) {
    std::vector<FaceIndex> ring;
    mesh_.faces_around(k, ring);
    std::vector<KnotIndex> around;  // each once: the next corner of each face
    for (const FaceIndex r : ring) {
      const mesh::Face& v = mesh_.face(r);
      const auto at = static_cast<std::size_t>(std::find(v.begin(), v.end(), k) - v.begin());
      around.push_back(v[(at + 1) % 3]);
    }
    if (!mesh_.remove(k)) return false;
    ++report_.removed;
    for (const KnotIndex j : around) {
      mesh_.faces_around(j, ring);
      touched.insert(touched.end(), ring.begin(), ring.end());
    }
    return true;
  }

  double deviation(KnotIndex k) const {
    std::vector<FaceIndex> ring;
    mesh_.faces_around(k, ring);
    Vec2 sum;
    std::size_t count = 0;
    for (const FaceIndex f : ring) {
      for (const KnotIndex j : mesh_.face(f)) {
        if (j == k) continue;
        sum = sum + (targets_[j] - mesh_.position(j));
        ++count;
      }
    }
    return norm(targets_[k] - mesh_.position(k) - (1.0 / static_cast<double>(count)) * sum);
  }

  /// Slows the knots of faces that are still bad, at last to rest. Ends, since what rests is sound.
  void hold_rest() {
    std::vector<int> slowed(targets_.size(), 0);
    for (std::vector<FaceIndex> bad = bad_faces(); !bad.empty(); bad = bad_faces()) {
      std::vector<bool> involved(targets_.size(), false);
      for (const FaceIndex f : bad) {
        for (const KnotIndex k : mesh_.face(f)) involved[k] = true;
      }
      // Knots inside segments follow the ends.
      for (const mesh::FeatureSegment& s : mesh_.segments()) {
        const bool any =
            std::any_of(s.knots.begin(), s.knots.end(), [&](KnotIndex k) { return involved[k]; });
        if (any) involved[s.knots.front()] = involved[s.knots.back()] = true;
      }
      for (KnotIndex k = 0; k < involved.size(); ++k) {
        if (!involved[k] || mesh_.knot(k).kind == KnotKind::kSegment) continue;
        const double share = ++slowed[k] < kSlowings ? 0.5 : 0.0;
        targets_[k] =
            share > 0 ? mesh_.position(k) + share * (targets_[k] - mesh_.position(k)) : mesh_.position(k);
      }
      follow_ends();
    }
    report_.held += static_cast<std::size_t>(
        std::count_if(slowed.begin(), slowed.end(), [](int times) { return times > 0; }));
  }

  /// Puts the knots inside segments between the ends as they were before the move.
  void follow_ends() {
    for (const mesh::FeatureSegment& s : mesh_.segments()) {
      const KnotIndex a = s.knots.front();
      const KnotIndex b = s.knots.back();
      const bool rests = targets_[a] == mesh_.position(a) && targets_[b] == mesh_.position(b);
      const Vec2 from = mesh_.position(a);
      const Vec2 along = mesh_.position(b) - from;
      for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
        const KnotIndex k = s.knots[i];
        const double t = dot(mesh_.position(k) - from, along) / dot(along, along);
        targets_[k] = rests ? mesh_.position(k) : targets_[a] + t * (targets_[b] - targets_[a]);
      }
    }
  }

  KnotMesh moved() {
    KnotMesh result = mesh_.to_mesh();
    std::size_t at = 0;
    for (KnotIndex k = 0; k < targets_.size(); ++k) {
      if (!mesh_.is_knot(k)) continue;
      if (result.knots[at].position != targets_[k]) ++report_.moved;
      result.knots[at++].position = targets_[k];
    }
    return result;
  }

  EditableMesh mesh_;
  std::vector<Vec2> targets_;
  std::vector<Vec2> wanted_;
  double least_;
  CarryReport& report_;
};

}  // namespace

KnotMesh carry_mesh(const KnotMesh& mesh, std::span<const Vec2> targets, std::span<const std::uint8_t> lost,
                    const CarryOptions& options, CarryReport* report) {
  CarryReport own;
  CarryReport& told = report ? *report : own;
  told = {};
  std::vector<std::size_t> indices;
  const KnotMesh kept = without_leaving_segments(mesh, targets, lost, indices);
  told.segments_dropped = mesh.segments.size() - indices.size();
  std::vector<Vec2> goals(targets.begin(), targets.end());
  // Knots of segments that are given up go on as free ones, those on the border stay.
  for (KnotIndex k = 0; k < goals.size(); ++k) {
    if (kept.knots[k].kind == KnotKind::kBorder) goals[k] = kept.knots[k].position;
  }
  Carrier carrier(kept, std::move(goals), options, told);
  KnotMesh result = carrier.run();
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (carrier.is_stuck(kept.segments[i])) told.stuck.push_back(indices[i]);
  }
  return result;
}

}  // namespace knotreel::track
