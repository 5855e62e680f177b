// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/clear_tangents.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace knotreel::vectorize {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;
using Edge = EditableMesh::Edge;

constexpr double kLeastAngle = 0.2;     // radians, from the tangent of a curve to an edge of the mesh
constexpr double kFarAngle = 1.7;       // radians: an edge so far from a segment is not beside it
constexpr double kTangentReach = 1.5;   // pixels along a curve, that tell its tangent
constexpr double kShortestCurve = 0.5;  // pixels: less says nothing of a tangent
constexpr double kSmooth = 0.3;         // cosine: what turns more is no joint
constexpr double kMostTurn = 0.5;  // radians, from an edge to the knot beside it; or from chord to tangent
constexpr double kShortest = 1.5;  // pixels, to that knot
constexpr double kHarm = 1;        // squared levels per pixel, that a flip may cost
constexpr int kMostEdges = 10;     // that are mended around a vertex

/// Of a curve at the end of a segment; unit vectors, away from there.
struct Tangent {
  Vec2 chord;  ///< along the segment
  Vec2 along;  ///< along the curve
};

/// Tangents at the knots of the segments of a mesh, by knot.
class Tangents {
 public:
  /// @param curves, segments as clear_tangents().
  Tangents(const EditableMesh& mesh, std::span<const fit::CurvePoint> curves,
           std::span<const std::uint32_t> segments, bool inside)
      : mesh_(mesh),
        inside_(inside),
        at_(mesh.knot_slots()),
        image_(mesh.knot_slots()),
        joint_(mesh.knot_slots(), false) {
    for (std::size_t i = 0; i < curves.size(); ++i) find_ends(curves[i], mesh.segments()[segments[i]]);
    const std::vector<std::vector<fit::CurvePoint>> points = by_segment(curves, segments);
    for (std::size_t s = 0; s < points.size(); ++s) {
      if (!points[s].empty()) add_segment(mesh.segments()[s], points[s]);
    }
    for (KnotIndex k = 0; k < at_.size(); ++k) {
      if (joint_[k] && at_[k].size() == 2) join(at_[k][0], at_[k][1]);
    }
  }

  std::vector<std::vector<Tangent>> take() { return std::move(at_); }

 private:
  /// The points of each segment, in their order. The first ones of a closed curve may be the end of its last
  /// segment, whose others come last.
  std::vector<std::vector<fit::CurvePoint>> by_segment(std::span<const fit::CurvePoint> curves,
                                                       std::span<const std::uint32_t> segments) const {
    std::vector<std::vector<fit::CurvePoint>> points(mesh_.segments().size());
    for (std::size_t begin = 0, end = 0; begin < curves.size(); begin = end) {
      while (end < curves.size() && segments[end] == segments[begin]) ++end;
      const auto run = curves.subspan(begin, end - begin);
      auto& all = points[segments[begin]];
      all.insert(all.begin(), run.begin(), run.end());
    }
    return points;
  }

  void find_ends(const fit::CurvePoint& point, const mesh::FeatureSegment& segment) {
    for (const KnotIndex end : {segment.knots.front(), segment.knots.back()}) {
      if (norm(point.parameter - mesh_.position(end)) >= 1e-9) continue;
      image_[end] = point.position;
      joint_[end] = joint_[end] || point.joint;
    }
  }

  void add_segment(const mesh::FeatureSegment& segment, std::span<const fit::CurvePoint> points) {
    const KnotIndex a = segment.knots.front();
    const KnotIndex b = segment.knots.back();
    if (!image_[a] || !image_[b]) return;
    std::vector<Vec2> curve{*image_[a]};
    for (const fit::CurvePoint& p : points) {
      if (p.position != curve.front() && p.position != *image_[b]) curve.push_back(p.position);
    }
    curve.push_back(*image_[b]);
    add(a, b, curve);
    std::reverse(curve.begin(), curve.end());
    add(b, a, curve);
    for (std::size_t i = 1; inside_ && i + 1 < segment.knots.size(); ++i)
      add_inside(segment.knots[i], segment, points);
  }

  /// At a knot inside a segment the curve goes on both ways.
  void add_inside(KnotIndex k, const mesh::FeatureSegment& segment, std::span<const fit::CurvePoint> points) {
    const KnotIndex a = segment.knots.front();
    const KnotIndex b = segment.knots.back();
    const double at = norm(mesh_.position(k) - mesh_.position(a));
    const auto along = [&](const fit::CurvePoint& p) { return norm(p.parameter - mesh_.position(a)); };
    const auto behind =
        std::find_if(points.begin(), points.end(), [&](const fit::CurvePoint& p) { return along(p) > at; });
    if (behind == points.begin() || behind == points.end()) return;
    const auto before = behind - 1;
    const double share = (at - along(*before)) / (along(*behind) - along(*before));
    const Vec2 image = before->position + share * (behind->position - before->position);
    std::vector<Vec2> on{image};
    for (auto p = behind; p != points.end(); ++p) on.push_back(p->position);
    on.push_back(*image_[b]);
    add(k, b, on);
    std::vector<Vec2> back{image};
    for (auto p = behind; p != points.begin(); --p) back.push_back((p - 1)->position);
    back.push_back(*image_[a]);
    add(k, a, back);
  }

  /// @param curve from one knot to the other.
  void add(KnotIndex from, KnotIndex to, const std::vector<Vec2>& curve) {
    const double length = norm(curve.back() - curve.front());
    if (!(length > kShortestCurve)) return;
    const auto farther = [&](double distance) {
      const auto there = std::find_if(curve.begin() + 1, curve.end() - 1,
                                      [&](Vec2 p) { return norm(p - curve.front()) >= distance; });
      return *there - curve.front();
    };
    // Directions of chords from there turn as evenly as the curve does.
    const Vec2 near = farther(std::min(kTangentReach, length / 3));
    const Vec2 far = farther(2 * norm(near));
    const double more = norm(far) - norm(near);
    const double turn = more > 0 ? angle_between(far, near) * norm(near) / more : 0;
    at_[from].push_back({unit(mesh_.position(to) - mesh_.position(from)),
                         turned(unit(near), std::clamp(turn, -kMostTurn, kMostTurn))});
  }

  /// One curve goes on into the other.
  static void join(Tangent& a, Tangent& b) {
    if (dot(a.along, b.along) > -kSmooth) return;
    a.along = unit(a.along - b.along);
    b.along = -1.0 * a.along;
  }

  const EditableMesh& mesh_;
  bool inside_;
  std::vector<std::vector<Tangent>> at_;
  std::vector<std::optional<Vec2>> image_;  ///< of knots at ends
  std::vector<bool> joint_;
};

class Clearer {
 public:
  Clearer(EditableMesh& mesh, const knots::Target& target, std::vector<std::vector<Tangent>> tangents,
          std::size_t most, double min_distance)
      : mesh_(mesh),
        target_(target),
        tangents_(std::move(tangents)),
        most_(most),
        min_distance_(min_distance) {}

  std::size_t run() {
    for (KnotIndex k = 0; k < tangents_.size(); ++k) clear(k);
    return inserted_;
  }

 private:
  /// An edge from a vertex that is too near to the tangent of a curve.
  struct Crowded {
    KnotIndex from, to;
    double angle;  ///< beyond the tangent, radians
    double side;   ///< of the segment that it is on, 1 or -1
  };

  void clear(KnotIndex k) {
    const bool may_part = mesh_.knot(k).kind != mesh::KnotKind::kSegment;
    const auto mend = [&](const Crowded& c) { return flip_away(c) || (may_part && part(c)); };
    for (int i = 0; i < kMostEdges && !tangents_[k].empty(); ++i) {
      const std::vector<Crowded> edges = crowded_edges(k);
      if (std::none_of(edges.begin(), edges.end(), mend)) return;
    }
  }

  /// What is left between tangents at a knot and an edge from there.
  std::optional<Crowded> crowd(KnotIndex from, KnotIndex to) const {
    std::optional<Crowded> least;
    if (from >= tangents_.size()) return least;
    const Vec2 edge = mesh_.position(to) - mesh_.position(from);
    for (const Tangent& t : tangents_[from]) {
      const double off = angle_between(t.chord, edge);
      if (std::abs(off) > kFarAngle) continue;
      const double side = off > 0 ? 1 : -1;
      const double angle = side * angle_between(t.along, edge);
      if (!least || angle < least->angle) least = Crowded{from, to, angle, side};
    }
    return least;
  }

  bool is_clear(KnotIndex from, KnotIndex to) const {
    const std::optional<Crowded> c = crowd(from, to);
    return !c || c->angle >= kLeastAngle;
  }

  /// The worst first.
  std::vector<Crowded> crowded_edges(KnotIndex k) {
    std::vector<Crowded> edges;
    mesh_.faces_around(k, around_);
    for (const FaceIndex f : around_) {
      for (int side = 0; side < 3; ++side) {
        const auto corner = [&](int i) { return mesh_.face(f)[static_cast<std::size_t>((side + i) % 3)]; };
        if ((corner(1) != k && corner(2) != k) || mesh_.is_fixed({f, side})) continue;
        const std::optional<Crowded> c = crowd(k, corner(1) == k ? corner(2) : corner(1));
        if (c && c->angle < kLeastAngle) edges.push_back(*c);
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Crowded& a, const Crowded& b) {
      return std::pair(a.angle, a.to) < std::pair(b.angle, b.to);
    });
    edges.erase(std::unique(edges.begin(), edges.end(),
                            [](const Crowded& a, const Crowded& b) { return a.to == b.to; }),
                edges.end());
    return edges;
  }

  KnotIndex apex(Edge e) const { return mesh_.face(e.face)[static_cast<std::size_t>(e.side)]; }

  bool flip_away(const Crowded& crowded) {
    const Edge edge = mesh_.edge_between(crowded.from, crowded.to);
    if (mesh_.is_fixed(edge) || !mesh_.can_flip(edge)) return false;
    const Edge other = mesh_.mirror(edge);
    const KnotIndex p = apex(edge);
    const KnotIndex q = apex(other);
    if (!is_clear(p, q) || !is_clear(q, p)) return false;
    const auto fit = [&](Edge e) { return target_.fit(mesh_.triangle(e.face)); };
    const knots::LinearFit before[] = {fit(edge), fit(other)};
    const double allowed = before[0].error + before[1].error + kHarm * (before[0].weight + before[1].weight);
    const Edge flipped = mesh_.flip(edge);
    if (fit(flipped).error + fit(mesh_.mirror(flipped)).error <= allowed) return true;
    mesh_.flip(flipped);
    return false;
  }

  /// Puts a knot on the far side of the edge, and flips the edge to it.
  bool part(const Crowded& crowded) {
    if (inserted_ >= most_) return false;
    Edge edge = mesh_.edge_between(crowded.from, crowded.to);
    if (mesh_.is_fixed(edge)) return false;
    const Vec2 a = mesh_.position(crowded.from);
    const Vec2 along = mesh_.position(crowded.to) - a;
    if (crowded.side * cross(along, mesh_.position(apex(edge)) - a) < 0) edge = mesh_.mirror(edge);
    const Vec2 far = mesh_.position(apex(edge)) - a;
    const double room = crowded.side * angle_between(along, far);
    if (!(room > 0)) return false;
    const double turn = std::min(room / 2, kMostTurn);
    if (crowded.angle + turn < kLeastAngle) return false;
    const Vec2 way = unit(turned(along, crowded.side * turn));
    const double reach = cross(along, far) / cross(way, far - along);  // to the third edge
    const double length = std::min(0.5 * norm(along), 0.6 * reach);
    if (!(length >= kShortest) || length * std::sin(turn) < min_distance_ / 2) return false;
    const KnotIndex k = mesh_.insert_in_face(edge.face, a + length * way);
    const Edge crossing = mesh_.edge_between(crowded.from, crowded.to);
    if (!mesh_.can_flip(crossing)) {
      mesh_.remove(k);
      return false;
    }
    mesh_.flip(crossing);
    ++inserted_;
    return true;
  }

  EditableMesh& mesh_;
  const knots::Target& target_;
  std::vector<std::vector<Tangent>> tangents_;
  std::size_t most_;
  double min_distance_;
  std::size_t inserted_ = 0;
  std::vector<FaceIndex> around_;
};

}  // namespace

std::size_t clear_tangents(EditableMesh& mesh, const knots::Target& target,
                           std::span<const fit::CurvePoint> curves, std::span<const std::uint32_t> segments,
                           bool inside, std::size_t most, double min_distance) {
  return Clearer(mesh, target, Tangents(mesh, curves, segments, inside).take(), most, min_distance).run();
}

}  // namespace knotreel::vectorize
