// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/refine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/place.h"

namespace knotreel::knots {

namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;

constexpr int kRing = 2;        // pixels: "two-ring" of paper sec. 8.1
constexpr int kThresholds = 8;  // halvings of the largest error at most

class ErrorMap {
 public:
  ErrorMap(std::span<const float> squared, int width, int height)
      : squared_(squared), width_(width), height_(height) {}

  std::size_t size() const { return squared_.size(); }
  double largest() const {
    return squared_.empty() ? 0 : *std::max_element(squared_.begin(), squared_.end());
  }

  template <class Visit>
  void for_ring(std::size_t pixel, Visit&& visit) const {
    const int x = static_cast<int>(pixel % static_cast<std::size_t>(width_));
    const int y = static_cast<int>(pixel / static_cast<std::size_t>(width_));
    for (int v = std::max(0, y - kRing); v <= std::min(height_ - 1, y + kRing); ++v) {
      for (int u = std::max(0, x - kRing); u <= std::min(width_ - 1, x + kRing); ++u) {
        visit(static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u));
      }
    }
  }

  double accumulated(std::size_t pixel) const {
    double sum = 0;
    for_ring(pixel, [&](std::size_t q) { sum += static_cast<double>(squared_[q]); });
    return sum;
  }

  bool is_above(std::size_t pixel, double threshold) const {
    return static_cast<double>(squared_[pixel]) > threshold;
  }

 private:
  std::span<const float> squared_;
  int width_;
  int height_;
};

/// Pixels above a squared error that falls, without those of small clusters. A cluster only grows while it
/// falls, so what is known to be in a large one stays there, and is never looked at again.
class Clusters {
 public:
  Clusters(const ErrorMap& errors, std::size_t least)
      : errors_(errors), least_(least), states_(errors.size(), State::kLeft) {}

  /// @return those that have come, in any order.
  std::vector<std::size_t> lower_to(double threshold) {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == State::kLeft && errors_.is_above(i, threshold)) states_[i] = State::kOpen;
    }
    std::vector<std::size_t> come;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == State::kOpen) add_cluster(i, come);
    }
    return come;
  }

 private:
  enum class State : std::uint8_t { kLeft, kOpen, kIn };

  /// Without what was in a large cluster before.
  void add_cluster(std::size_t seed, std::vector<std::size_t>& come) {
    const std::size_t first = come.size();
    bool is_large = false;
    come.push_back(seed);
    states_[seed] = State::kLeft;
    for (std::size_t i = first; i < come.size(); ++i) {
      errors_.for_ring(come[i], [&](std::size_t q) {
        if (states_[q] == State::kIn) is_large = true;
        if (states_[q] != State::kOpen) return;
        states_[q] = State::kLeft;
        come.push_back(q);
      });
    }
    is_large = is_large || come.size() - first >= least_;
    if (!is_large) return come.resize(first);
    for (std::size_t i = first; i < come.size(); ++i) states_[come[i]] = State::kIn;
  }

  const ErrorMap& errors_;
  std::size_t least_;
  std::vector<State> states_;
};

struct Candidate {
  double error;
  std::size_t pixel;
};

bool is_better(const Candidate& a, const Candidate& b) {
  return a.error != b.error ? a.error > b.error : a.pixel < b.pixel;
}

/// For each face the pixel with the largest accumulated error.
class BestByFace {
 public:
  BestByFace(const ErrorMap& errors, const std::vector<FaceIndex>& face_of)
      : errors_(errors), face_of_(face_of) {}

  void add(const std::vector<std::size_t>& pixels) {
    std::vector<double> accumulated(pixels.size());
    constexpr std::size_t kBlock = 256;
    parallel_for((pixels.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(pixels.size(), (block + 1) * kBlock); ++i)
        accumulated[i] = errors_.accumulated(pixels[i]);
    });
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Candidate candidate{accumulated[i], pixels[i]};
      const FaceIndex f = face_of_[pixels[i]];
      if (f >= best_of_.size()) best_of_.resize(f + std::size_t{1}, 0);
      if (best_of_[f] == 0) {
        best_.push_back(candidate);
        best_of_[f] = best_.size();
      } else if (is_better(candidate, best_[best_of_[f] - 1])) {
        best_[best_of_[f] - 1] = candidate;
      }
    }
  }

  std::size_t count() const { return best_.size(); }

  std::vector<Candidate> largest_first() const {
    std::vector<Candidate> sorted = best_;
    std::sort(sorted.begin(), sorted.end(), is_better);
    return sorted;
  }

 private:
  const ErrorMap& errors_;
  const std::vector<FaceIndex>& face_of_;
  std::vector<Candidate> best_;
  std::vector<std::size_t> best_of_;  ///< by face: its place among the best, from 1 on
};

/// The face of every pixel's place; the faces partition the pixels.
std::vector<FaceIndex> faces_of_pixels(const EditableMesh& mesh, std::span<const Vec2> places, int width,
                                       int height) {
  std::vector<FaceIndex> by_centre(std::size_t(width) * std::size_t(height), 0);
  parallel_for(mesh.face_slots(), [&](std::size_t face) {
    const auto f = static_cast<FaceIndex>(face);
    if (!mesh.is_face(f)) return;
    const TriangleRows rows(mesh.triangle(f), width, height);
    for (int y = rows.first(); y < rows.last(); ++y) {
      int begin = 0;
      int end = 0;
      rows.columns(y, begin, end);
      for (int x = begin; x < end; ++x) by_centre[std::size_t(y) * std::size_t(width) + std::size_t(x)] = f;
    }
  });
  if (places.empty()) return by_centre;
  std::vector<FaceIndex> result(by_centre.size());
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    for (std::size_t i = row * std::size_t(width); i < (row + 1) * std::size_t(width); ++i) {
      const int x = std::clamp(static_cast<int>(places[i].x), 0, width - 1);
      const int y = std::clamp(static_cast<int>(places[i].y), 0, height - 1);
      result[i] = by_centre[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    }
  });
  return result;
}

/// Faces that knots on their edges have split since it was asked which pixel is in which.
class SplitFaces {
 public:
  explicit SplitFaces(const EditableMesh& mesh) : mesh_(mesh) {}

  void add_around(KnotIndex k) {
    mesh_.faces_around(k, ring_);
    for (const FaceIndex f : ring_) {
      if (f >= split_.size()) split_.resize(f + std::size_t{1}, false);
      split_[f] = true;
    }
  }

  /// The part of a face in which a place is now.
  FaceIndex part(FaceIndex f, Vec2 place) const {
    for (int steps = 0; steps < kMostSteps && is_split(f); ++steps) {
      const FaceIndex next = towards(f, place);
      if (next == f || !is_split(next)) break;
      f = next;
    }
    return f;
  }

 private:
  static constexpr int kMostSteps = 8;  // there are hardly ever more than two

  bool is_split(FaceIndex f) const { return f < split_.size() && split_[f]; }

  FaceIndex towards(FaceIndex f, Vec2 place) const {
    const auto t = mesh_.triangle(f);
    for (std::size_t i = 0; i < 3; ++i) {
      if (signed_area(t[(i + 1) % 3], t[(i + 2) % 3], place) < 0 && !mesh_.is_fixed({f, static_cast<int>(i)}))
        return mesh_.neighbour(f, static_cast<int>(i));
    }
    return f;
  }

  const EditableMesh& mesh_;
  std::vector<bool> split_;
  std::vector<FaceIndex> ring_;
};

}  // namespace

std::vector<KnotIndex> refine_knots(EditableMesh& mesh, std::span<const float> squared_errors,
                                    std::span<const Vec2> places, int width, int height,
                                    const RefineOptions& options) {
  std::vector<KnotIndex> inserted;
  const ErrorMap errors(squared_errors, width, height);
  const double largest = errors.largest();
  if (options.max_knots == 0 || !(largest > 0)) return inserted;
  const std::vector<FaceIndex> face_of = faces_of_pixels(mesh, places, width, height);
  Clusters clusters(errors, options.least_cluster);
  BestByFace best(errors, face_of);
  for (int s = 1; s <= kThresholds && best.count() < options.max_knots; ++s)
    best.add(clusters.lower_to(largest * std::exp2(-2.0 * s)));  // squared errors
  SplitFaces split(mesh);
  for (const Candidate& c : best.largest_first()) {
    if (inserted.size() == options.max_knots) break;
    const Vec2 centre{static_cast<double>(c.pixel % std::size_t(width)) + 0.5,
                      static_cast<double>(c.pixel / std::size_t(width)) + 0.5};
    const Vec2 wanted = places.empty() ? centre : places[c.pixel];
    const auto k = insert_near(mesh, split.part(face_of[c.pixel], wanted), wanted, options.min_distance);
    if (!k) continue;
    inserted.push_back(*k);
    split.add_around(*k);
  }
  return inserted;
}

std::vector<KnotIndex> refine_features(EditableMesh& mesh, std::span<const CurveError> errors, double bound,
                                       double min_distance) {
  // Intervals by segment and first knot, found before any of them is split.
  std::vector<std::pair<std::uint32_t, std::size_t>> intervals;
  for (const CurveError& e : errors) {
    if (!(e.error > bound)) continue;
    const auto& knots = mesh.segments()[e.segment].knots;
    const Vec2 from = mesh.position(knots.front());
    const Vec2 along = mesh.position(knots.back()) - from;
    const double at = dot(e.place - from, along);
    std::size_t i = 0;
    while (i + 2 < knots.size() && dot(mesh.position(knots[i + 1]) - from, along) < at) ++i;
    intervals.emplace_back(e.segment, i);
  }
  std::sort(intervals.begin(), intervals.end());
  intervals.erase(std::unique(intervals.begin(), intervals.end()), intervals.end());
  std::vector<KnotIndex> inserted;
  // Backwards, so that the places of earlier knots of a segment stay valid.
  for (auto it = intervals.rbegin(); it != intervals.rend(); ++it) {
    const KnotIndex a = mesh.segments()[it->first].knots[it->second];
    const KnotIndex b = mesh.segments()[it->first].knots[it->second + 1];
    const Vec2 p = mesh.position(a);
    const Vec2 q = mesh.position(b);
    if (norm(q - p) < 4 * min_distance) continue;
    const KnotIndex first = mesh.insert_on_edge(mesh.edge_between(a, b), p + (1.0 / 3) * (q - p));
    const KnotIndex second = mesh.insert_on_edge(mesh.edge_between(first, b), p + (2.0 / 3) * (q - p));
    inserted.insert(inserted.end(), {first, second});
  }
  return inserted;
}

std::vector<bool> rings_around(const EditableMesh& mesh, const std::vector<KnotIndex>& knots, int count) {
  std::vector<bool> active(mesh.knot_slots(), false);
  std::vector<KnotIndex> front = knots;
  for (const KnotIndex k : knots) active[k] = true;
  std::vector<FaceIndex> ring;
  for (int step = 0; step < count; ++step) {
    std::vector<KnotIndex> next;
    for (const KnotIndex k : front) {
      mesh.faces_around(k, ring);
      for (const FaceIndex f : ring) {
        for (const KnotIndex j : mesh.face(f)) {
          if (!active[j]) next.push_back(j);
          active[j] = true;
        }
      }
    }
    front = std::move(next);
  }
  return active;
}

}  // namespace knotreel::knots
