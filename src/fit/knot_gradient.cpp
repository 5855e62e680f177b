#include "knotreel/fit/knot_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "spline/places.h"

namespace knotreel::fit {

namespace {

using mesh::KnotIndex;
using mesh::KnotKind;
using spline::Affine;
using spline::Piece;
using spline::PieceTerm;

constexpr double kStep = 1e-4;  // pixels

/// Two unit directions in which a knot may move; the second is unused for knots on a line.
struct Directions {
  int count = 0;
  std::array<Vec2, 2> d{};
};

std::vector<Directions> free_directions(const mesh::KnotMesh& mesh) {
  std::vector<Directions> result(mesh.knots.size());
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    const mesh::Knot& knot = mesh.knots[k];
    if (knot.kind == KnotKind::kFree) result[k] = {2, {Vec2{1, 0}, Vec2{0, 1}}};
    if (knot.kind == KnotKind::kBorder) {
      const bool upright = knot.position.x == 0 || knot.position.x == mesh.width;
      result[k] = {1, {upright ? Vec2{0, 1} : Vec2{1, 0}, Vec2{}}};
    }
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 along = mesh.knots[s.knots.back()].position - mesh.knots[s.knots.front()].position;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      result[s.knots[i]] = {1, {(1 / norm(along)) * along, Vec2{}}};
    }
  }
  return result;
}

/// Columns of row y where a term can be positive, for pixels at most `slack` from their centres.
std::pair<int, int> columns_of(const PieceTerm& term, double y, double slack, int width) {
  double low = term.low.x - slack;
  double high = term.high.x + slack;
  const auto clip = [&](const Affine& a) {
    if (a.nx == 0) return;
    const double spare = slack * (std::abs(a.nx) + std::abs(a.ny));
    const double zero = a.px - (a.ny * (y - a.py) + spare) / a.nx;
    if (a.nx > 0) low = std::max(low, zero);
    if (a.nx < 0) high = std::min(high, zero);
  };
  for (int i = 0; i < term.tent.slope_count; ++i) clip(term.tent.slopes[static_cast<std::size_t>(i)]);
  for (int i = 0; i < term.tent.wall_count; ++i) clip(term.tent.walls[static_cast<std::size_t>(i)]);
  const auto clamped = [width](double v) { return static_cast<int>(std::clamp(v, 0.0, double(width))); };
  return {clamped(std::ceil(low - 0.5)), clamped(std::floor(high - 0.5) + 1)};
}

/// One row of pixels around a config: residual times control point, for each of its three functions.
struct ResidualRow {
  std::array<std::vector<double>, 3> q;
  int begin = 0;
};

/// Tent, factor and weights of one piece, with what is missing filled in so that it changes nothing: one loop
/// for all kinds.
struct Shape {
  std::array<Affine, 4> slopes{};
  std::array<double, 4> high{1e300, 1e300, 1e300, 1e300};
  std::array<Affine, 3> walls{};
  std::array<double, 3> inside{1, 1, 1};
  Affine factor{};
  double plain = 1;
  std::array<Affine, 3> weights{};
};

Shape shape_of(const Piece& piece, const PieceTerm& term) {
  Shape s;
  if (term.tent.slope_count == 0) s.high[0] = term.tent.constant;
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.slope_count); ++i) {
    s.slopes[i] = term.tent.slopes[i];
    s.high[i] = 0;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i) {
    s.walls[i] = term.tent.walls[i];
    s.inside[i] = 0;
  }
  if (term.has_factor) {
    s.factor = term.factor;
    s.plain = 0;
  }
  s.weights = piece.weights;
  return s;
}

/// Sum over n pixels at (x, y) of tent * factor * sum_v weights[v] * q[v].
KNOTREEL_MULTIVERSION
double row_sum(const Shape& shape, const double* __restrict x, const double* __restrict y,
               const double* __restrict q0, const double* __restrict q1, const double* __restrict q2, int n) {
  const Shape s = shape;
  const auto at = [&](int i) {
    const double ux = x[i];
    const double uy = y[i];
    const auto value = [&](const Affine& a) { return a.nx * (ux - a.px) + a.ny * (uy - a.py); };
    const double v0 = value(s.slopes[0]) + s.high[0];
    const double v1 = value(s.slopes[1]) + s.high[1];
    const double v2 = value(s.slopes[2]) + s.high[2];
    const double v3 = value(s.slopes[3]) + s.high[3];
    const double a = v1 < v0 ? v1 : v0;
    const double b = v3 < v2 ? v3 : v2;
    double v = b < a ? b : a;
    v = v > 0 ? v : 0;
    const double d0 = value(s.walls[0]) + s.inside[0];
    const double d1 = value(s.walls[1]) + s.inside[1];
    const double d2 = value(s.walls[2]) + s.inside[2];
    const double d01 = d1 < d0 ? d1 : d0;
    const double d = d2 < d01 ? d2 : d01;
    v = d > 0 ? v : 0;
    return v * (value(s.factor) + s.plain) *
           (value(s.weights[0]) * q0[i] + value(s.weights[1]) * q1[i] + value(s.weights[2]) * q2[i]);
  };
  // Eight sums side by side: the order is fixed, whatever the vector width.
  double sums[8] = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    for (int l = 0; l < 8; ++l) sums[l] += at(i + l);
  }
  for (int l = 0; i < n; ++i, ++l) sums[l] += at(i);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

class Differences {
 public:
  Differences(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit)
      : basis_(basis),
        pixels_(pixels),
        fit_(fit),
        directions_(free_directions(basis.space().mesh())),
        places_(pixels.image->width, pixels.image->height, 1, 1, pixels.places),
        weighted_(fit.residual),
        centres_(static_cast<std::size_t>(pixels.image->width)) {
    const auto channels = static_cast<std::size_t>(pixels.image->channels);
    for (std::size_t i = 0; i < weighted_.size() && !pixels.weights.empty(); ++i) {
      weighted_[i] *= pixels.weights[i / channels];
    }
    for (std::size_t x = 0; x < centres_.size(); ++x) centres_[x] = static_cast<double>(x) + 0.5;
  }

  struct Share {
    KnotIndex knot;
    Vec2 value;
  };

  /// d/dt of sum over pixels of r . S_config for the knots of one config, times the directions.
  void add_config(std::size_t config, std::vector<Share>& out) const {
    const spline::SplineSpace& space = basis_.space();
    const spline::Config& c = space.configs()[config];
    std::array<KnotIndex, 5> knots{};
    std::size_t count = 0;
    const auto add_knot = [&](spline::CornerIndex corner) {
      const KnotIndex k = space.cut().corners[corner].knot;
      if (std::find(knots.begin(), knots.begin() + static_cast<std::ptrdiff_t>(count), k) ==
          knots.begin() + static_cast<std::ptrdiff_t>(count)) {
        knots[count++] = k;
      }
    };
    for (const auto corner : c.triangle) add_knot(corner);
    for (int i = 0; i + 1 < space.degree(); ++i) add_knot(c.inner[static_cast<std::size_t>(i)]);

    std::vector<Variant> variants;
    add_variant(config, {mesh::KnotIndex(0xffffffffu), {}}, variants);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 p = space.mesh().knots[knots[i]].position;
      for (int d = 0; d < directions_[knots[i]].count; ++d) {
        const Vec2 direction = directions_[knots[i]].d[static_cast<std::size_t>(d)];
        add_variant(config, {knots[i], p + kStep * direction}, variants);
      }
    }
    if (variants.size() == 1) return;
    sum_variants(c, variants);
    std::size_t v = 1;
    for (std::size_t i = 0; i < count; ++i) {
      Share share{knots[i], {}};
      for (int d = 0; d < directions_[knots[i]].count; ++d, ++v) {
        const double slope = (variants[v].sum - variants[0].sum) / kStep;
        share.value = share.value + slope * directions_[knots[i]].d[static_cast<std::size_t>(d)];
      }
      out.push_back(share);
    }
  }

 private:
  struct Variant {
    Piece piece;
    std::vector<PieceTerm> terms;
    std::vector<Shape> shapes;
    double sum = 0;
  };

  void add_variant(std::size_t config, const spline::KnotShift& shift, std::vector<Variant>& out) const {
    Variant v;
    v.piece = spline::make_shifted_piece(basis_.space(), config, shift, v.terms);
    for (const PieceTerm& term : v.terms) v.shapes.push_back(shape_of(v.piece, term));
    out.push_back(std::move(v));
  }

  void sum_variants(const spline::Config& config, std::vector<Variant>& variants) const {
    const image::Image& image = *pixels_.image;
    Vec2 low{1e300, 1e300};
    Vec2 high{-1e300, -1e300};
    for (const Variant& v : variants) {
      for (const PieceTerm& t : v.terms) {
        low = {std::min(low.x, t.low.x), std::min(low.y, t.low.y)};
        high = {std::max(high.x, t.high.x), std::max(high.y, t.high.y)};
      }
    }
    if (!(low.x <= high.x)) return;
    const double slack = places_.reach(low, high);
    const auto clamped = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, double(n))); };
    const int left = clamped(std::ceil(low.x - slack - 0.5), image.width);
    const int right = clamped(std::floor(high.x + slack - 0.5) + 1, image.width);
    const int top = clamped(std::ceil(low.y - slack - 0.5), image.height);
    const int bottom = clamped(std::floor(high.y + slack - 0.5) + 1, image.height);
    thread_local ResidualRow row;
    row.begin = left;
    for (auto& q : row.q) q.resize(static_cast<std::size_t>(std::max(0, right - left)));
    for (int y = top; y < bottom; ++y) {
      // Only where the piece as it is can be positive; a shift by kStep hardly reaches beyond.
      int from = right;
      int to = left;
      for (const PieceTerm& term : variants[0].terms) {
        const auto [first, last] = columns_of(term, y + 0.5, slack + 2 * kStep, image.width);
        from = std::min(from, std::max(first, left));
        to = std::max(to, std::min(last, right));
      }
      if (from >= to) continue;
      fill_row(config, y, from, to, row);
      const double* x = slack > 0 ? places_.x(y) + from : centres_.data() + from;
      const double* v = slack > 0 ? places_.y(y) + from : heights(y);
      const auto at = static_cast<std::size_t>(from - left);
      for (Variant& variant : variants) {
        for (const Shape& shape : variant.shapes) {
          variant.sum += row_sum(shape, x, v, row.q[0].data() + at, row.q[1].data() + at,
                                 row.q[2].data() + at, to - from);
        }
      }
    }
  }

  /// A row of equal heights for pixels at their centres.
  const double* heights(int y) const {
    thread_local std::vector<double> row;
    row.assign(centres_.size(), y + 0.5);
    return row.data();
  }

  /// Weighted residual times control points for the pixels [from, to) of a row.
  void fill_row(const spline::Config& config, int y, int from, int to, ResidualRow& row) const {
    const auto channels = static_cast<std::size_t>(pixels_.image->channels);
    const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels_.image->width);
    for (std::size_t v = 0; v < 3; ++v) {
      double* q = row.q[v].data() - row.begin;
      if (config.functions[v] == spline::kNoFunction) {
        std::fill(q + from, q + to, 0.0);
        continue;
      }
      const double* control = fit_.control.data() + config.functions[v] * channels;
      const float* r = weighted_.data() + (start + static_cast<std::size_t>(from)) * channels;
      for (int x = from; x < to; ++x, r += channels) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c) sum += static_cast<double>(r[c]) * control[c];
        q[x] = sum;
      }
    }
  }

  const spline::Basis& basis_;
  const Pixels& pixels_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
  spline::Places places_;
  std::vector<float> weighted_;  ///< residual times weight
  std::vector<double> centres_;  ///< x of the pixels of a row
};

}  // namespace

std::vector<Vec2> knot_gradient(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit) {
  const Differences differences(basis, pixels, fit);
  const std::size_t configs = basis.space().configs().size();
  constexpr std::size_t kBlock = 128;
  std::vector<std::vector<Differences::Share>> shares((configs + kBlock - 1) / kBlock);
  parallel_for(shares.size(), [&](std::size_t b) {
    for (std::size_t c = b * kBlock; c < std::min(configs, (b + 1) * kBlock); ++c) {
      differences.add_config(c, shares[b]);
    }
  });
  std::vector<Vec2> gradient(basis.space().mesh().knots.size());
  for (const auto& block : shares) {
    for (const auto& s : block) gradient[s.knot] = gradient[s.knot] - 2 * s.value;
  }
  return gradient;
}

}  // namespace knotreel::fit
