#include <algorithm>
#include <cmath>
#include <span>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"
#include "spline/jet.h"

namespace knotreel::fit {

namespace {

using spline::Basis;

// The map may shrink areas to this share; below that it counts as about to fold.
constexpr double kLeastArea = 0.05;
constexpr double kShrink = 0.85;  // of displacements at folds, each time
constexpr int kMaxRounds = 24;
constexpr double kAlong = 0.75;                     // pixels between samples along a feature
constexpr double kAcross[] = {0.0, 0.7, 1.5, 3.0};  // pixels from the feature

/// Points on both sides of the features, where the map bends most, with the side to look at them from.
struct Sample {
  Vec2 u;
  Vec2 direction;
};

std::vector<Sample> feature_samples(const mesh::KnotMesh& mesh) {
  std::vector<Sample> samples;
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 b = mesh.knots[s.knots.back()].position;
    const double length = norm(b - a);
    const Vec2 normal = (1 / length) * Vec2{a.y - b.y, b.x - a.x};
    const int count = std::max(2, static_cast<int>(std::ceil(length / kAlong)));
    for (int i = 0; i < count; ++i) {
      const Vec2 p = a + ((i + 0.5) / count) * (b - a);
      for (const double side : {-1.0, 1.0}) {
        for (const double distance : kAcross) {
          const Vec2 u = p + (side * distance) * normal;
          if (u.x < 0 || u.y < 0 || u.x > mesh.width || u.y > mesh.height) break;
          samples.push_back({u, side * normal});
        }
      }
    }
  }
  return samples;
}

/// How one control point of the geometry changes the Jacobian of the map at a sample.
struct Slope {
  std::uint32_t group;
  double dx;
  double dy;
};

/// Those of some samples, one after the other.
struct Slopes {
  std::vector<Slope> slopes;
  std::vector<std::size_t> ends;
};

/// Calls visit(slopes) for each sample, in order.
template <class Visit>
void for_samples(const std::vector<Slopes>& blocks, Visit&& visit) {
  for (const Slopes& block : blocks) {
    std::size_t begin = 0;
    for (const std::size_t end : block.ends) {
      visit(std::span(block.slopes).subspan(begin, end - begin));
      begin = end;
    }
  }
}

/// Adds to the slope of a group, which is among those from `first` on or comes behind them.
void add(std::vector<Slope>& slopes, std::size_t first, const Slope& more) {
  std::size_t i = first;
  while (i < slopes.size() && slopes[i].group != more.group) ++i;
  if (i == slopes.size()) {
    slopes.push_back(more);
  } else {
    slopes[i].dx += more.dx;
    slopes[i].dy += more.dy;
  }
}

/// By piece: whether some control point of its functions is displaced. The others change nothing: what is not
/// displaced does not get so by shrinking.
std::vector<std::uint8_t> displaced_pieces(const Basis& basis, std::span<const Vec2> displacement) {
  const std::span<const std::uint32_t> geometry_of = basis.space().geometry_of();
  std::vector<std::uint8_t> displaced;
  displaced.reserve(basis.pieces().pieces.size());
  for (const spline::Piece& piece : basis.pieces().pieces) {
    displaced.push_back(
        std::any_of(piece.functions.begin(), piece.functions.end(), [&](spline::FunctionIndex f) {
          return f != spline::kNoFunction && displacement[geometry_of[f]] != Vec2{};
        }));
  }
  return displaced;
}

void append_slopes(const Basis& basis, std::span<const std::uint8_t> displaced, const Sample& sample,
                   std::vector<Slope>& slopes) {
  const std::size_t first = slopes.size();
  const spline::PieceSet& set = basis.pieces();
  const spline::TermIndex& index = basis.index();
  for (const spline::TermIndex::Entry& e : index.at(sample.u)) {
    if (!displaced[e.piece] || !index.near(e, sample.u)) continue;
    const spline::Jet w = term_jet(set.terms[e.term], sample.u, sample.direction);
    if (w.value == 0 && w.dx == 0 && w.dy == 0) continue;
    const spline::Piece& piece = set.pieces[e.piece];
    for (std::size_t k = 0; k < 3; ++k) {
      if (piece.functions[k] == spline::kNoFunction) continue;
      const spline::Affine& weight = piece.weights[k];
      const double value = weight(sample.u);
      add(slopes, first,
          {basis.space().geometry_of()[piece.functions[k]], w.dx * value + w.value * weight.nx,
           w.dy * value + w.value * weight.ny});
    }
  }
}

std::vector<Slopes> slopes_at(const Basis& basis, std::span<const std::uint8_t> displaced,
                              const std::vector<Sample>& samples) {
  constexpr std::size_t kSamples = 256;
  constexpr std::size_t kSlopes = 16;  // per sample, that room is made for
  std::vector<Slopes> blocks((samples.size() + kSamples - 1) / kSamples);
  parallel_for(blocks.size(), [&](std::size_t b) {
    Slopes& block = blocks[b];
    block.slopes.reserve(kSlopes * kSamples);
    block.ends.reserve(kSamples);
    for (std::size_t i = b * kSamples; i < std::min(samples.size(), (b + 1) * kSamples); ++i) {
      append_slopes(basis, displaced, samples[i], block.slopes);
      block.ends.push_back(block.slopes.size());
    }
  });
  return blocks;
}

}  // namespace

std::size_t unfold_geometry(const Basis& basis, std::vector<Vec2>& displacement) {
  const std::vector<Slopes> blocks =
      slopes_at(basis, displaced_pieces(basis, displacement), feature_samples(basis.space().mesh()));
  std::vector<std::uint8_t> shrink(displacement.size());
  std::size_t folds = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::fill(shrink.begin(), shrink.end(), std::uint8_t{0});
    folds = 0;
    for_samples(blocks, [&](std::span<const Slope> slopes) {
      Vec2 by_x{1, 0};
      Vec2 by_y{0, 1};
      for (const Slope& s : slopes) {
        by_x = by_x + s.dx * displacement[s.group];
        by_y = by_y + s.dy * displacement[s.group];
      }
      if (cross(by_x, by_y) >= kLeastArea) return;
      ++folds;
      for (const Slope& s : slopes) shrink[s.group] = 1;
    });
    if (folds == 0) break;
    for (std::size_t g = 0; g < displacement.size(); ++g) {
      if (shrink[g]) displacement[g] = kShrink * displacement[g];
    }
  }
  return folds;
}

}  // namespace knotreel::fit
