#include "fit/folds.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/box.h"
#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "spline/jet.h"
#include "spline/plane.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::PieceTerm;
using Plane = spline::PlaneIn<float>;

constexpr double kAlong = 0.75;  // pixels between samples along a feature
/// Pixels from the feature, but not on it: then no sample is on a wall.
constexpr double kAcross[] = {1e-3, 0.7, 1.5, 3.0};

Box box_of(std::span<const Vec2> places) {
  Box box;
  for (const Vec2 p : places) box.add(p);
  return box;
}

/// A term about an origin. Where a tent has fewer slopes or walls than there may be, the last slope is there
/// again, and walls are far away.
struct LocalTerm {
  std::array<Plane, 4> slopes;
  std::array<Plane, 3> walls;
  Plane factor{1, 0, 0};
};

LocalTerm local_term(const PieceTerm& term, Vec2 origin) {
  const auto plane = [&](const spline::Affine& a) { return spline::plane_in<float>(plane_of(a, origin)); };
  LocalTerm local;
  local.slopes.fill({static_cast<float>(term.tent.constant), 0, 0});
  for (int i = 0; i < 4 && term.tent.slope_count > 0; ++i) {
    const int at = std::min(i, term.tent.slope_count - 1);
    local.slopes[static_cast<std::size_t>(i)] = plane(term.tent.slopes[static_cast<std::size_t>(at)]);
  }
  local.walls.fill({1, 0, 0});
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i)
    local.walls[i] = plane(term.tent.walls[i]);
  if (term.has_factor) local.factor = plane(term.factor);
  return local;
}

/// Derivatives of a displacement at the samples of a batch.
template <std::size_t N>
struct Derivatives {
  alignas(64) std::array<float, N> xx{};  ///< of x by x
  alignas(64) std::array<float, N> xy{};  ///< of x by y
  alignas(64) std::array<float, N> yx{};
  alignas(64) std::array<float, N> yy{};
};

/// Adds those of a term times the displacement (x, y) of its piece.
template <std::size_t N>
[[gnu::always_inline]] inline void add_in(const LocalTerm& term, Plane x, Plane y, const float* __restrict px,
                                          const float* __restrict py, Derivatives<N>& sums) {
  const auto [s0, s1, s2, s3] = term.slopes;
  const auto [w0, w1, w2] = term.walls;
  const Plane factor = term.factor;
  float* __restrict const xx = sums.xx.data();
  float* __restrict const xy = sums.xy.data();
  float* __restrict const yx = sums.yx.data();
  float* __restrict const yy = sums.yy.data();
  for (std::size_t i = 0; i < N; ++i) {
    const auto at = [ux = px[i], uy = py[i]](const Plane& p) { return p.c + p.x * ux + p.y * uy; };
    const float v0 = at(s0), v1 = at(s1), v2 = at(s2), v3 = at(s3);
    const float low = v1 < v0 ? v1 : v0;
    const float other_low = v3 < v2 ? v3 : v2;
    const float v = other_low < low ? other_low : low;
    // Shares rather than branches, for vectors.
    const float is1 = v1 == v ? 1.0F : 0.0F;
    const float is2 = v2 == v ? 1 - is1 : 0.0F;
    const float is3 = v3 == v ? 1 - is1 - is2 : 0.0F;
    const float by_x = s0.x + is1 * (s1.x - s0.x) + is2 * (s2.x - s0.x) + is3 * (s3.x - s0.x);
    const float by_y = s0.y + is1 * (s1.y - s0.y) + is2 * (s2.y - s0.y) + is3 * (s3.y - s0.y);
    const float d0 = at(w0), d1 = at(w1), d2 = at(w2);
    const float near = d1 < d0 ? d1 : d0;
    const float nearest = d2 < near ? d2 : near;
    const float inside = nearest < v ? nearest : v;
    const float in = inside > 0 ? 1.0F : 0.0F;
    const float f = at(factor) * in;
    const float w = v * f;
    const float w_x = by_x * f + v * factor.x * in;
    const float w_y = by_y * f + v * factor.y * in;
    xx[i] += w_x * at(x) + w * x.x;
    xy[i] += w_y * at(x) + w * x.y;
    yx[i] += w_x * at(y) + w * y.x;
    yy[i] += w_y * at(y) + w * y.y;
  }
}

KNOTREEL_MULTIVERSION
void add_term(const LocalTerm& term, const Plane& x, const Plane& y, const float* px, const float* py,
              Derivatives<64>& sums) {
  add_in(term, x, y, px, py, sums);
}

}  // namespace

Folds::Folds(const spline::Basis& basis, std::span<const Vec2> displacement) : basis_(basis) {
  motions_.reserve(basis.pieces().pieces.size());
  for (const spline::Piece& piece : basis.pieces().pieces) motions_.push_back(motion_of(piece, displacement));
  std::vector<std::size_t> ends;  // of the batches of segments
  for (const mesh::FeatureSegment& segment : basis.space().mesh().segments) {
    add_batches(segment);
    ends.push_back(batches_.size());
  }
  parallel_for(ends.size(), [&](std::size_t s) {
    const std::size_t begin = s == 0 ? 0 : ends[s - 1];
    add_terms(std::span(batches_).subspan(begin, ends[s] - begin));
  });
}

void Folds::add_batches(const mesh::FeatureSegment& segment) {
  const mesh::KnotMesh& mesh = basis_.space().mesh();
  const Vec2 a = mesh.knots[segment.knots.front()].position;
  const Vec2 b = mesh.knots[segment.knots.back()].position;
  const double length = norm(b - a);
  const Vec2 normal = (1 / length) * Vec2{a.y - b.y, b.x - a.x};
  const int count = std::max(2, static_cast<int>(std::ceil(length / kAlong)));
  batches_.emplace_back();
  for (int i = 0; i < count; ++i) {
    const Vec2 p = a + ((i + 0.5) / count) * (b - a);
    for (const double side : {-1.0, 1.0}) {
      for (const double distance : kAcross) {
        const Vec2 u = p + (side * distance) * normal;
        if (u.x < 0 || u.y < 0 || u.x > mesh.width || u.y > mesh.height) break;
        if (batches_.back().places.size() == kSamples) batches_.emplace_back();
        batches_.back().places.push_back(u);
      }
    }
  }
}

/// Those of the batches of a segment: looked for once for all of them.
void Folds::add_terms(std::span<Batch> batches) const {
  const spline::TermIndex& index = basis_.index();
  Box all;
  for (const Batch& batch : batches) {
    for (const Vec2 p : batch.places) all.add(p);
  }
  std::vector<spline::TermIndex::Entry> terms;
  if (all.low.x > all.high.x) return;  // no sample is in the domain
  index.in_box(all.low, all.high, terms);
  // The others change nothing: what is not displaced does not get so by shrinking.
  std::erase_if(terms, [&](const spline::TermIndex::Entry& e) { return !motions_[e.piece].any; });
  for (Batch& batch : batches) {
    const Box box = box_of(batch.places);
    for (const spline::TermIndex::Entry& e : terms) {
      const auto& [low, high] = index.box(e.term);
      if (low.x <= box.high.x && high.x >= box.low.x && low.y <= box.high.y && high.y >= box.low.y)
        batch.terms.push_back(e);
    }
  }
}

Folds::Motion Folds::motion_of(const spline::Piece& piece, std::span<const Vec2> displacement) const {
  Motion motion;
  for (std::size_t k = 0; k < 3; ++k) {
    if (piece.functions[k] == spline::kNoFunction) continue;
    const Vec2 d = displacement[basis_.space().geometry_of()[piece.functions[k]]];
    if (d == Vec2{}) continue;
    const spline::Affine& weight = piece.weights[k];
    motion.at_zero = motion.at_zero + weight({}) * d;
    motion.by_x = motion.by_x + weight.nx * d;
    motion.by_y = motion.by_y + weight.ny * d;
    motion.any = true;
  }
  return motion;
}

/// Of the map at the samples, of which those that are missing are like the first.
Folds::Values Folds::areas(const Batch& batch) const {
  const Vec2 origin = batch.places.front();
  alignas(64) Values x{};
  alignas(64) Values y{};
  for (std::size_t i = 0; i < batch.places.size(); ++i) {
    x[i] = static_cast<float>(batch.places[i].x - origin.x);
    y[i] = static_cast<float>(batch.places[i].y - origin.y);
  }
  Derivatives<kSamples> sums;
  for (const spline::TermIndex::Entry& e : batch.terms) {
    const Motion& motion = motions_[e.piece];
    const Vec2 here = motion.at_zero + origin.x * motion.by_x + origin.y * motion.by_y;
    const Plane move_x = spline::plane_in<float>({here.x, motion.by_x.x, motion.by_y.x});
    const Plane move_y = spline::plane_in<float>({here.y, motion.by_x.y, motion.by_y.y});
    add_term(local_term(basis_.pieces().terms[e.term], origin), move_x, move_y, x.data(), y.data(), sums);
  }
  Values areas;
  for (std::size_t i = 0; i < kSamples; ++i)
    areas[i] = (1 + sums.xx[i]) * (1 + sums.yy[i]) - sums.xy[i] * sums.yx[i];
  return areas;
}

std::size_t Folds::find(double least_area) {
  parallel_for(batches_.size(), [&](std::size_t b) {
    Batch& batch = batches_[b];
    if (batch.is_known || batch.places.empty()) return;
    const Values found = areas(batch);
    batch.folded = 0;
    for (std::size_t i = 0; i < batch.places.size(); ++i) {
      if (static_cast<double>(found[i]) < least_area) batch.folded |= std::uint64_t{1} << i;
    }
    batch.is_known = true;
  });
  std::size_t count = 0;
  for (const Batch& batch : batches_) count += static_cast<std::size_t>(std::popcount(batch.folded));
  return count;
}

std::vector<std::uint8_t> Folds::groups() const {
  std::vector<std::uint8_t> groups(basis_.space().geometry_count(), 0);
  for (const Batch& batch : batches_) {
    for (std::size_t i = 0; i < batch.places.size(); ++i) {
      if ((batch.folded >> i & 1U) == 0) continue;
      for (const spline::TermIndex::Entry& e : batch.terms) {
        if (term_jet(basis_.pieces().terms[e.term], batch.places[i], {}) == spline::Jet{}) continue;
        for (const FunctionIndex f : basis_.pieces().pieces[e.piece].functions) {
          if (f != spline::kNoFunction) groups[basis_.space().geometry_of()[f]] = 1;
        }
      }
    }
  }
  return groups;
}

void Folds::change(std::span<const Vec2> displacement, const std::vector<std::uint8_t>& changed) {
  const std::vector<spline::Piece>& pieces = basis_.pieces().pieces;
  std::vector<std::uint8_t> touched(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    touched[p] = std::any_of(pieces[p].functions.begin(), pieces[p].functions.end(), [&](FunctionIndex f) {
      return f != spline::kNoFunction && changed[basis_.space().geometry_of()[f]];
    });
    if (touched[p]) motions_[p] = motion_of(pieces[p], displacement);
  }
  for (Batch& batch : batches_) {
    batch.is_known = std::none_of(batch.terms.begin(), batch.terms.end(),
                                  [&](const spline::TermIndex::Entry& e) { return touched[e.piece]; });
  }
}

}  // namespace knotreel::fit
