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

constexpr double kStep = 1e-5;  // pixels, for differences of coefficients

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

/// c + x (ux - ox) + y (uy - oy) with a common origin o: what pieces are made of, so that they can be
/// subtracted.
struct Plane {
  double c = 0;
  double x = 0;
  double y = 0;
};

Plane plane_of(const Affine& a, Vec2 origin) {
  return {a(origin), a.nx, a.ny};
}

Plane operator-(const Plane& a, const Plane& b) {
  return {a.c - b.c, a.x - b.x, a.y - b.y};
}

/// One term of a piece: min of the slopes, inside the walls, times the factor, times the three weights. What
/// is missing is filled in so that it changes nothing: one loop for all kinds.
struct Shape {
  std::array<Plane, 4> slopes{Plane{1e300, 0, 0}, Plane{1e300, 0, 0}, Plane{1e300, 0, 0}, Plane{1e300, 0, 0}};
  std::array<Plane, 3> walls{Plane{1, 0, 0}, Plane{1, 0, 0}, Plane{1, 0, 0}};
  Plane factor{1, 0, 0};
  std::array<Plane, 3> weights{};
};

Shape shape_of(const Piece& piece, const PieceTerm& term, Vec2 origin) {
  Shape s;
  if (term.tent.slope_count == 0) s.slopes[0] = {term.tent.constant, 0, 0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.slope_count); ++i) {
    s.slopes[i] = plane_of(term.tent.slopes[i], origin);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i) {
    s.walls[i] = plane_of(term.tent.walls[i], origin);
  }
  if (term.has_factor) s.factor = plane_of(term.factor, origin);
  for (std::size_t i = 0; i < 3; ++i) s.weights[i] = plane_of(piece.weights[i], origin);
  return s;
}

/// Sums over pixels of a quantity, of it times x - ox, and of it times y - oy.
struct PlaneMoments {
  double c = 0;
  double x = 0;
  double y = 0;
};

double dot(const Plane& p, const PlaneMoments& m) {
  return p.c * m.c + p.x * m.x + p.y * m.y;
}

/// Derivative of sum over pixels of (q_0 w_0 + q_1 w_1 + q_2 w_2) * factor * min of slopes by each of its
/// planes.
struct ShapeGradient {
  std::array<PlaneMoments, 4> slopes{};
  PlaneMoments factor{};
  std::array<PlaneMoments, 3> weights{};
};

/// How the sum changes when the planes change like this.
double change(const ShapeGradient& g, const Shape& from, const Shape& to) {
  double sum = dot(to.factor - from.factor, g.factor);
  for (std::size_t i = 0; i < 4; ++i) sum += dot(to.slopes[i] - from.slopes[i], g.slopes[i]);
  for (std::size_t i = 0; i < 3; ++i) sum += dot(to.weights[i] - from.weights[i], g.weights[i]);
  return sum;
}

/// A row of pixels, padded with zeros to a multiple of kLanes: places relative to the origin, and residual
/// times control point for each of the three functions.
struct PixelRow {
  static constexpr std::size_t kLanes = 8;
  std::vector<double> x, y;
  std::array<std::vector<double>, 3> q;
  /// Scratch: the quantities whose moments are taken.
  std::array<std::vector<double>, 8> out;

  void resize(std::size_t n) {
    const std::size_t padded = (n + kLanes - 1) / kLanes * kLanes;
    for (auto* v : {&x, &y, &q[0], &q[1], &q[2]}) v->assign(padded, 0.0);
    for (auto& v : out) v.resize(padded);
  }
};

/// Adds one row.
KNOTREEL_MULTIVERSION
void add_row(const Shape& shape, PixelRow& row, ShapeGradient& gradient) {
  const Shape s = shape;
  const std::size_t n = row.x.size();
  const double* __restrict x = row.x.data();
  const double* __restrict y = row.y.data();
  const double* __restrict q0 = row.q[0].data();
  const double* __restrict q1 = row.q[1].data();
  const double* __restrict q2 = row.q[2].data();
  double* __restrict o0 = row.out[0].data();
  double* __restrict o1 = row.out[1].data();
  double* __restrict o2 = row.out[2].data();
  double* __restrict o3 = row.out[3].data();
  double* __restrict of = row.out[4].data();
  double* __restrict p0 = row.out[5].data();
  double* __restrict p1 = row.out[6].data();
  double* __restrict p2 = row.out[7].data();
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = [&](const Plane& p) { return p.c + p.x * x[i] + p.y * y[i]; };
    const double v0 = at(s.slopes[0]);
    const double v1 = at(s.slopes[1]);
    const double v2 = at(s.slopes[2]);
    const double v3 = at(s.slopes[3]);
    const double a = v1 < v0 ? v1 : v0;
    const double b = v3 < v2 ? v3 : v2;
    const double least = b < a ? b : a;
    const double d0 = at(s.walls[0]);
    const double d1 = at(s.walls[1]);
    const double d2 = at(s.walls[2]);
    const double d01 = d1 < d0 ? d1 : d0;
    const double d = d2 < d01 ? d2 : d01;
    double v = least > 0 ? least : 0;
    v = d > 0 ? v : 0;
    const double share = at(s.weights[0]) * q0[i] + at(s.weights[1]) * q1[i] + at(s.weights[2]) * q2[i];
    const double f = at(s.factor);
    const double slope = v > 0 ? share * f : 0;
    // Each pixel counts for the slope that rules there; ties go to the first.
    o0[i] = v0 <= least ? slope : 0;
    o1[i] = v1 <= least && v0 > least ? slope : 0;
    o2[i] = v2 <= least && a > least ? slope : 0;
    o3[i] = v3 <= least && a > least && v2 > least ? slope : 0;
    of[i] = v * share;
    p0[i] = v * f * q0[i];
    p1[i] = v * f * q1[i];
    p2[i] = v * f * q2[i];
  }
  const auto add = [&](const double* __restrict o, PlaneMoments& m) {
    double c[PixelRow::kLanes] = {};
    double mx[PixelRow::kLanes] = {};
    double my[PixelRow::kLanes] = {};
    for (std::size_t i = 0; i < n; i += PixelRow::kLanes) {
      for (std::size_t l = 0; l < PixelRow::kLanes; ++l) {
        c[l] += o[i + l];
        mx[l] += o[i + l] * x[i + l];
        my[l] += o[i + l] * y[i + l];
      }
    }
    for (std::size_t l = 0; l < PixelRow::kLanes; ++l) {
      m.c += c[l];
      m.x += mx[l];
      m.y += my[l];
    }
  };
  for (std::size_t k = 0; k < 4; ++k) {
    if (s.slopes[k].c < 1e299) add(row.out[k].data(), gradient.slopes[k]);
  }
  if (s.factor.x != 0 || s.factor.y != 0) add(of, gradient.factor);
  add(p0, gradient.weights[0]);
  add(p1, gradient.weights[1]);
  add(p2, gradient.weights[2]);
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

class Derivatives {
 public:
  Derivatives(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit)
      : basis_(basis),
        image_(*pixels.image),
        fit_(fit),
        directions_(free_directions(basis.space().mesh())),
        places_(image_.width, image_.height, 1, 1, pixels.places),
        weighted_(fit.residual) {
    const auto channels = static_cast<std::size_t>(image_.channels);
    for (std::size_t i = 0; i < weighted_.size() && !pixels.weights.empty(); ++i) {
      weighted_[i] *= pixels.weights[i / channels];
    }
  }

  struct Share {
    KnotIndex knot;
    Vec2 value;
  };

  /// d/dt of sum over pixels of r . S_config for the knots of one config.
  void add_config(std::size_t config, std::vector<Share>& out) const {
    const Piece& piece = basis_.pieces().pieces[config];
    if (piece.term_begin == piece.term_end) return;
    const auto terms =
        std::span(basis_.pieces().terms).subspan(piece.term_begin, piece.term_end - piece.term_begin);
    const spline::SplineSpace& space = basis_.space();
    const Vec2 origin = space.position(space.configs()[config].triangle[0]);
    thread_local std::vector<Shape> shapes;
    thread_local std::vector<ShapeGradient> gradients;
    shapes.clear();
    for (const PieceTerm& term : terms) shapes.push_back(shape_of(piece, term, origin));
    gradients.assign(shapes.size(), {});
    sum_pixels(config, terms, origin, shapes, gradients);

    thread_local std::vector<PieceTerm> shifted;
    for (const KnotIndex k : knots_of(config)) {
      Share share{k, {}};
      for (int d = 0; d < directions_[k].count; ++d) {
        const Vec2 direction = directions_[k].d[static_cast<std::size_t>(d)];
        shifted.clear();
        const Piece moved = spline::make_shifted_piece(
            space, config, {k, space.mesh().knots[k].position + kStep * direction}, shifted);
        if (shifted.size() != shapes.size()) continue;  // as good as degenerate
        double sum = 0;
        for (std::size_t t = 0; t < shapes.size(); ++t) {
          if (shifted[t].tent.slope_count != terms[t].tent.slope_count) continue;
          sum += change(gradients[t], shapes[t], shape_of(moved, shifted[t], origin));
        }
        share.value = share.value + (sum / kStep) * direction;
      }
      if (directions_[k].count > 0) out.push_back(share);
    }
  }

 private:
  std::vector<KnotIndex> knots_of(std::size_t config) const {
    const spline::SplineSpace& space = basis_.space();
    const spline::Config& c = space.configs()[config];
    std::vector<KnotIndex> knots;
    for (const auto corner : c.triangle) knots.push_back(space.cut().corners[corner].knot);
    for (int i = 0; i + 1 < space.degree(); ++i) {
      knots.push_back(space.cut().corners[c.inner[static_cast<std::size_t>(i)]].knot);
    }
    std::sort(knots.begin(), knots.end());
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    return knots;
  }

  void sum_pixels(std::size_t config, std::span<const PieceTerm> terms, Vec2 origin,
                  const std::vector<Shape>& shapes, std::vector<ShapeGradient>& gradients) const {
    // All terms of a piece have the same box.
    const Vec2 low = terms.front().low;
    const Vec2 high = terms.front().high;
    const double slack = places_.reach(low, high);
    const auto clamped = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, double(n))); };
    const int top = clamped(std::ceil(low.y - slack - 0.5), image_.height);
    const int bottom = clamped(std::floor(high.y + slack - 0.5) + 1, image_.height);
    thread_local PixelRow row;
    for (int y = top; y < bottom; ++y) {
      int from = image_.width;
      int to = 0;
      for (const PieceTerm& term : terms) {
        const auto [first, last] = columns_of(term, y + 0.5, slack, image_.width);
        if (first >= last) continue;
        from = std::min(from, first);
        to = std::max(to, last);
      }
      if (from >= to) continue;
      fill_row(config, y, from, to, origin, slack > 0, row);
      for (std::size_t t = 0; t < terms.size(); ++t) add_row(shapes[t], row, gradients[t]);
    }
  }

  /// The pixels [from, to) of a row.
  void fill_row(std::size_t config, int y, int from, int to, Vec2 origin, bool moved, PixelRow& row) const {
    const auto n = static_cast<std::size_t>(to - from);
    row.resize(n);
    if (moved) {
      const double* x = places_.x(y) + from;
      const double* v = places_.y(y) + from;
      for (std::size_t i = 0; i < n; ++i) row.x[i] = x[i] - origin.x;
      for (std::size_t i = 0; i < n; ++i) row.y[i] = v[i] - origin.y;
    } else {
      for (std::size_t i = 0; i < n; ++i) row.x[i] = (from + 0.5 - origin.x) + static_cast<double>(i);
      std::fill_n(row.y.begin(), n, y + 0.5 - origin.y);
    }
    const auto channels = static_cast<std::size_t>(image_.channels);
    const float* pixels =
        weighted_.data() +
        (static_cast<std::size_t>(y) * std::size_t(image_.width) + static_cast<std::size_t>(from)) * channels;
    const auto& functions = basis_.space().configs()[config].functions;
    for (std::size_t v = 0; v < 3; ++v) {
      if (functions[v] == spline::kNoFunction) continue;
      const double* control = fit_.control.data() + functions[v] * channels;
      const float* r = pixels;
      for (std::size_t i = 0; i < n; ++i, r += channels) {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c) sum += static_cast<double>(r[c]) * control[c];
        row.q[v][i] = sum;
      }
    }
  }

  const spline::Basis& basis_;
  const image::Image& image_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
  spline::Places places_;
  std::vector<float> weighted_;  ///< residual times weight
};

}  // namespace

std::vector<Vec2> knot_gradient(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit) {
  const Derivatives derivatives(basis, pixels, fit);
  const std::size_t configs = basis.space().configs().size();
  constexpr std::size_t kBlock = 128;
  std::vector<std::vector<Derivatives::Share>> shares((configs + kBlock - 1) / kBlock);
  parallel_for(shares.size(), [&](std::size_t b) {
    for (std::size_t c = b * kBlock; c < std::min(configs, (b + 1) * kBlock); ++c) {
      derivatives.add_config(c, shares[b]);
    }
  });
  std::vector<Vec2> gradient(basis.space().mesh().knots.size());
  for (const auto& block : shares) {
    for (const auto& s : block) gradient[s.knot] = gradient[s.knot] - 2 * s.value;
  }
  return gradient;
}

}  // namespace knotreel::fit
