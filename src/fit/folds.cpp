// SPDX-License-Identifier: GPL-3.0-or-later
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
using FloatPlane = spline::PlaneIn<float>;

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
  std::array<FloatPlane, 4> slopes;
  std::array<FloatPlane, 3> walls;
  FloatPlane factor{1, 0, 0};
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

/// Adds the derivatives of a term times the displacement (x, y) of its piece at N samples.
/// @param sums Derivatives of Folds.
template <std::size_t N, class Sums>
[[gnu::always_inline]] inline void add_in(const LocalTerm& term, FloatPlane x, FloatPlane y,
                                          const float* __restrict px, const float* __restrict py,
                                          Sums& sums) {
  const auto [s0, s1, s2, s3] = term.slopes;
  const auto [w0, w1, w2] = term.walls;
  const FloatPlane factor = term.factor;
  float* __restrict const xx = sums.xx.data();
  float* __restrict const xy = sums.xy.data();
  float* __restrict const yx = sums.yx.data();
  float* __restrict const yy = sums.yy.data();
  for (std::size_t i = 0; i < N; ++i) {
    const auto at = [ux = px[i], uy = py[i]](const FloatPlane& p) { return p.c + p.x * ux + p.y * uy; };
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

/// Sums that a multiversion function can take.
struct SumsOf64 {
  std::span<float, 64> xx, xy, yx, yy;
};

KNOTREEL_MULTIVERSION
void add_term(const LocalTerm& term, const FloatPlane& x, const FloatPlane& y, const float* px,
              const float* py, SumsOf64& sums) {
  add_in<64>(term, x, y, px, py, sums);
}

}  // namespace

void Folds::Derivatives::scale(float factor) {
  for (auto* const values : {&xx, &xy, &yx, &yy}) {
    for (float& v : *values) v *= factor;
  }
}

void Folds::Derivatives::add(const Derivatives& other, float factor) {
  for (std::size_t i = 0; i < kSamples; ++i) {
    xx[i] += factor * other.xx[i];
    xy[i] += factor * other.xy[i];
    yx[i] += factor * other.yx[i];
    yy[i] += factor * other.yy[i];
  }
}

Folds::Folds(const spline::Basis& basis, std::span<const Vec2> displacement)
    : basis_(basis), displacement_(displacement.begin(), displacement.end()) {
  std::vector<Motion> motions;
  motions.reserve(basis.pieces().pieces.size());
  for (const spline::Piece& piece : basis.pieces().pieces) motions.push_back(motion_of(piece));
  std::vector<std::size_t> ends;  // of the batches of segments
  for (const mesh::FeatureSegment& segment : basis.space().mesh().segments) {
    add_batches(segment);
    ends.push_back(batches_.size());
  }
  parallel_for(ends.size(), [&](std::size_t s) {
    const std::size_t begin = s == 0 ? 0 : ends[s - 1];
    const auto batches = std::span(batches_).subspan(begin, ends[s] - begin);
    add_terms(batches, motions);
    for (Batch& batch : batches) {
      if (batch.places.empty()) continue;
      batch.all = derivatives(batch, [&](std::uint32_t piece) { return motions[piece]; });
    }
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
void Folds::add_terms(std::span<Batch> batches, const std::vector<Motion>& motions) const {
  const spline::TermIndex& index = basis_.index();
  Box all;
  for (const Batch& batch : batches) {
    for (const Vec2 p : batch.places) all.add(p);
  }
  std::vector<spline::TermIndex::Entry> terms;
  if (all.low.x > all.high.x) return;  // no sample is in the domain
  index.in_box(all.low, all.high, terms);
  // The others change nothing: what is not displaced does not get so by shrinking.
  std::erase_if(terms, [&](const spline::TermIndex::Entry& e) { return !motions[e.piece].any; });
  for (Batch& batch : batches) {
    const Box box = box_of(batch.places);
    for (const spline::TermIndex::Entry& e : terms) {
      const auto& [low, high] = index.box(e.term);
      if (low.x <= box.high.x && high.x >= box.low.x && low.y <= box.high.y && high.y >= box.low.y)
        batch.terms.push_back(e);
    }
  }
}

Folds::Motion Folds::motion_of(const spline::Piece& piece, std::span<const std::uint8_t> chosen) const {
  Motion motion;
  for (std::size_t k = 0; k < 3; ++k) {
    if (piece.functions[k] == spline::kNoFunction) continue;
    const std::uint32_t group = basis_.space().geometry_of()[piece.functions[k]];
    const Vec2 d = displacement_[group];
    if (d == Vec2{} || (!chosen.empty() && !chosen[group])) continue;
    const spline::Affine& weight = piece.weights[k];
    motion.at_zero = motion.at_zero + weight({}) * d;
    motion.by_x = motion.by_x + weight.nx * d;
    motion.by_y = motion.by_y + weight.ny * d;
    motion.any = true;
  }
  return motion;
}

/// Samples that are missing are like the first.
template <class MotionOf>
Folds::Derivatives Folds::derivatives(const Batch& batch, const MotionOf& motion_of) const {
  const Vec2 origin = batch.places.front();
  alignas(64) std::array<float, kSamples> x{};
  alignas(64) std::array<float, kSamples> y{};
  for (std::size_t i = 0; i < batch.places.size(); ++i) {
    x[i] = static_cast<float>(batch.places[i].x - origin.x);
    y[i] = static_cast<float>(batch.places[i].y - origin.y);
  }
  Derivatives sums;
  SumsOf64 all{sums.xx, sums.xy, sums.yx, sums.yy};
  for (const spline::TermIndex::Entry& e : batch.terms) {
    const Motion motion = motion_of(e.piece);
    if (!motion.any) continue;
    const Vec2 here = motion.at_zero + origin.x * motion.by_x + origin.y * motion.by_y;
    const FloatPlane move_x = spline::plane_in<float>({here.x, motion.by_x.x, motion.by_y.x});
    const FloatPlane move_y = spline::plane_in<float>({here.y, motion.by_x.y, motion.by_y.y});
    add_term(local_term(basis_.pieces().terms[e.term], origin), move_x, move_y, x.data(), y.data(), all);
  }
  return sums;
}

std::size_t Folds::find(double least_area) {
  for (Batch& batch : batches_) {
    if (batch.is_known) continue;
    batch.folded = 0;
    for (std::size_t i = 0; i < batch.places.size(); ++i) {
      const Derivatives& d = batch.all;
      const float area = (1 + d.xx[i]) * (1 + d.yy[i]) - d.xy[i] * d.yx[i];
      if (static_cast<double>(area) < least_area) batch.folded |= std::uint64_t{1} << i;
    }
    batch.is_known = true;
  }
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

void Folds::name_groups() {
  std::vector<std::vector<std::uint32_t>> groups(batches_.size());
  parallel_for(batches_.size(), [&](std::size_t b) {
    for (const spline::TermIndex::Entry& e : batches_[b].terms) {
      for (const FunctionIndex f : basis_.pieces().pieces[e.piece].functions) {
        if (f != spline::kNoFunction) groups[b].push_back(basis_.space().geometry_of()[f]);
      }
    }
    std::sort(groups[b].begin(), groups[b].end());
    groups[b].erase(std::unique(groups[b].begin(), groups[b].end()), groups[b].end());
  });
  reached_.resize(displacement_.size());
  for (std::uint32_t b = 0; b < groups.size(); ++b) {
    for (const std::uint32_t g : groups[b]) reached_[g].push_back(b);
  }
}

void Folds::shrink(const std::vector<std::uint8_t>& shrinking, double factor) {
  if (reached_.empty()) name_groups();
  std::vector<std::vector<std::uint32_t>> groups(batches_.size());  // that shrink, in order
  for (std::uint32_t g = 0; g < shrinking.size(); ++g) {
    if (!shrinking[g]) continue;
    for (const std::uint32_t b : reached_[g]) groups[b].push_back(g);
  }
  parallel_for(batches_.size(), [&](std::size_t b) {
    if (!groups[b].empty()) shrink(batches_[b], std::move(groups[b]), shrinking, factor);
  });
  for (std::size_t g = 0; g < displacement_.size(); ++g) {
    if (shrinking[g]) displacement_[g] = factor * displacement_[g];
  }
}

void Folds::shrink(Batch& batch, std::vector<std::uint32_t> groups, std::span<const std::uint8_t> shrinking,
                   double factor) const {
  if (groups != batch.shrinking) {
    batch.part = derivatives(
        batch, [&](std::uint32_t piece) { return motion_of(basis_.pieces().pieces[piece], shrinking); });
    batch.shrinking = std::move(groups);
  }
  batch.all.add(batch.part, static_cast<float>(factor) - 1);
  batch.part.scale(static_cast<float>(factor));
  batch.is_known = false;
}

}  // namespace knotreel::fit
