// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/place.h"

#include <algorithm>
#include <optional>
#include <queue>

#include "knots/disc_walk.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;

// Nearer to a fixed edge than this share of its length, a knot goes onto the edge.
constexpr double kNearEdge = 0.12;

/// Centroid of the squared error of a face.
Vec2 error_centroid(const EditableMesh& mesh, const Target& target, FaceIndex f) {
  const auto triangle = mesh.triangle(f);
  const LinearFit fit = target.fit(triangle);
  double sum = 0;
  Vec2 moment;
  target.for_pixels(triangle, [&](int x, int y) {
    const Vec2 u{x + 0.5, y + 0.5};
    double squared = 0;
    for (int c = 0; c < target.channels(); ++c) {
      const double d =
          static_cast<double>(target.image().at(x, y, c)) - fit.at(u, static_cast<std::size_t>(c));
      squared += d * d;
    }
    squared *= target.weight(x, y);
    sum += squared;
    moment = moment + squared * u;
  });
  return sum > 0 ? (1 / sum) * moment : (1.0 / 3) * (triangle[0] + triangle[1] + triangle[2]);
}

/// Where a knot can go: inside the face, or onto one of its edges.
struct Place {
  Vec2 position;
  int side = -1;  ///< the edge opposite this corner, or -1
};

std::optional<Place> find_place(const EditableMesh& mesh, FaceIndex f, Vec2 wanted, double distance) {
  const auto v = mesh.triangle(f);
  for (int i = 0; i < 3; ++i) {
    if (!mesh.is_fixed({f, i})) continue;
    const Vec2 a = v[static_cast<std::size_t>((i + 1) % 3)];
    const Vec2 b = v[static_cast<std::size_t>((i + 2) % 3)];
    const double length = norm(b - a);
    if (distance_to_segment(wanted, a, b) >= std::max(distance, kNearEdge * length)) continue;
    if (length < 4 * distance) return std::nullopt;
    const double t = std::clamp(dot(wanted - a, b - a) / (length * length), 0.25, 0.75);
    const Vec2 p = a + t * (b - a);
    if (!far_from_knots(mesh, f, p, distance)) return std::nullopt;
    return Place{p, i};
  }
  // A little inside, so that no new face is flat from the start.
  const Vec2 centre = (1.0 / 3) * (v[0] + v[1] + v[2]);
  for (const double pull : {0.0, 0.5, 1.0}) {
    const Vec2 p = wanted + pull * (centre - wanted);
    const bool inside = signed_area(v[0], v[1], p) > 0.05 && signed_area(v[1], v[2], p) > 0.05 &&
                        signed_area(v[2], v[0], p) > 0.05;
    if (inside && far_from_knots(mesh, f, p, distance) && far_from_lines(mesh, f, p, distance)) {
      return Place{p, -1};
    }
  }
  return std::nullopt;
}

/// Faces by error, largest first; entries of faces that have changed since are skipped.
class FaceQueue {
 public:
  FaceQueue(const EditableMesh& mesh, const Target& target) : mesh_(mesh), target_(target) {}

  void update(FaceIndex f) {
    if (f >= errors_.size()) {
      errors_.resize(mesh_.face_slots(), 0);
      versions_.resize(mesh_.face_slots(), 0);
    }
    total_ -= errors_[f];
    errors_[f] = target_.error(mesh_.triangle(f));
    total_ += errors_[f];
    queue_.push({errors_[f], f, ++versions_[f]});
  }

  /// The face with the largest error, which leaves the queue until it is updated.
  std::optional<FaceIndex> pop() {
    while (!queue_.empty()) {
      const Entry e = queue_.top();
      queue_.pop();
      if (e.version == versions_[e.face]) return e.face;
    }
    return std::nullopt;
  }

  double error(FaceIndex f) const { return errors_[f]; }
  double total() const { return total_; }

 private:
  struct Entry {
    double error;
    FaceIndex face;
    std::uint32_t version;
    bool operator<(const Entry& other) const {
      return error != other.error ? error < other.error : face > other.face;
    }
  };
  const EditableMesh& mesh_;
  const Target& target_;
  std::vector<double> errors_;
  std::vector<std::uint32_t> versions_;
  std::priority_queue<Entry> queue_;
  double total_ = 0;
};

}  // namespace

std::optional<KnotIndex> insert_near(EditableMesh& mesh, FaceIndex face, Vec2 wanted, double min_distance) {
  const auto place = find_place(mesh, face, wanted, min_distance);
  if (!place) return std::nullopt;
  if (place->side < 0) return mesh.insert_in_face(face, place->position);
  return mesh.insert_on_edge({face, place->side}, place->position);
}

std::size_t insert_knots(EditableMesh& mesh, const Target& target, const PlaceOptions& options) {
  FaceQueue queue(mesh, target);
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (mesh.is_face(f)) queue.update(f);
  }
  const double enough = options.mec * options.mec * static_cast<double>(target.image().pixel_count());
  std::size_t inserted = 0;
  std::vector<FaceIndex> ring;
  while (mesh.knot_count() < options.max_knots) {
    const double total = queue.total();
    const auto f = queue.pop();
    if (!f || (total <= enough && queue.error(*f) <= options.face_error)) break;
    const auto k = insert_near(mesh, *f, error_centroid(mesh, target, *f), options.min_distance);
    if (!k) continue;
    mesh.legalise_around(*k);
    mesh.faces_around(*k, ring);
    for (const FaceIndex g : ring) queue.update(g);
    ++inserted;
  }
  return inserted;
}

}  // namespace knotreel::knots
