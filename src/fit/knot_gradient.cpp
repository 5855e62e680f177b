#include "knotreel/fit/knot_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
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

/// None for knots that are not wanted.
std::vector<Directions> free_directions(const mesh::KnotMesh& mesh, std::span<const std::uint8_t> wanted) {
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
  for (KnotIndex k = 0; k < wanted.size(); ++k) {
    if (!wanted[k]) result[k] = {};
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
  std::array<Plane, 4> slopes{Plane{1e30, 0, 0}, Plane{1e30, 0, 0}, Plane{1e30, 0, 0}, Plane{1e30, 0, 0}};
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

/// Pixels that are summed side by side: the order of the sums is fixed, whatever the vector width.
constexpr std::size_t kLanes = 8;

/// Sums over pixels of a quantity, of it times x - ox, and of it times y - oy, by lanes.
struct PlaneMoments {
  std::array<double, kLanes> c{};
  std::array<double, kLanes> x{};
  std::array<double, kLanes> y{};
};

double dot(const Plane& p, const PlaneMoments& m) {
  const auto sum = [](const std::array<double, kLanes>& v) {
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
  };
  return p.c * sum(m.c) + p.x * sum(m.x) + p.y * sum(m.y);
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

/// The quantities of one row whose moments are taken: o0 to o3 for the slopes, each where it rules, of for
/// the factor and p0 to p2 for the weights.
[[gnu::always_inline]] inline void fill_quantities(const Shape& s, std::size_t n, const double* __restrict x,
                                                   const double* __restrict y, const double* __restrict q0,
                                                   const double* __restrict q1, const double* __restrict q2,
                                                   double* __restrict o0, double* __restrict o1,
                                                   double* __restrict o2, double* __restrict o3,
                                                   double* __restrict of, double* __restrict p0,
                                                   double* __restrict p1, double* __restrict p2) {
  const Plane s0 = s.slopes[0], s1 = s.slopes[1], s2 = s.slopes[2], s3 = s.slopes[3];
  const Plane a0 = s.walls[0], a1 = s.walls[1], a2 = s.walls[2];
  const Plane w0 = s.weights[0], w1 = s.weights[1], w2 = s.weights[2], wf = s.factor;
  for (std::size_t i = 0; i < n; ++i) {
    const double ux = x[i];
    const double uy = y[i];
    const auto at = [ux, uy](const Plane& p) { return p.c + p.x * ux + p.y * uy; };
    const double v0 = at(s0);
    const double v1 = at(s1);
    const double v2 = at(s2);
    const double v3 = at(s3);
    const double a = v1 < v0 ? v1 : v0;
    const double b = v3 < v2 ? v3 : v2;
    const double least = b < a ? b : a;
    const double d0 = at(a0);
    const double d1 = at(a1);
    const double d2 = at(a2);
    const double d01 = d1 < d0 ? d1 : d0;
    const double d = d2 < d01 ? d2 : d01;
    // Each pixel counts for the slope that rules there; ties go to the first. Products with 0 or 1, because
    // choices that depend on each other keep the compiler from using vectors.
    const double inside = d > 0 ? 1.0 : 0.0;
    const double above = least > 0 ? 1.0 : 0.0;
    const double rules0 = v0 <= least ? 1.0 : 0.0;
    const double rules1 = v1 <= least ? 1.0 : 0.0;
    const double rules2 = v2 <= least ? 1.0 : 0.0;
    const double positive = inside * above;
    const double v = least * positive;
    const double share = at(w0) * q0[i] + at(w1) * q1[i] + at(w2) * q2[i];
    const double f = at(wf);
    const double slope0 = share * f * positive;
    const double slope1 = slope0 - slope0 * rules0;
    const double slope2 = slope1 - slope1 * rules1;
    o0[i] = slope0 * rules0;
    o1[i] = slope1 * rules1;
    o2[i] = slope2 * rules2;
    o3[i] = slope2 - slope2 * rules2;
    of[i] = v * share;
    p0[i] = v * f * q0[i];
    p1[i] = v * f * q1[i];
    p2[i] = v * f * q2[i];
  }
}

[[gnu::always_inline]] inline void add_moments(std::size_t n, const double* __restrict x,
                                               const double* __restrict y, const double* __restrict o,
                                               PlaneMoments& moments) {
  PlaneMoments sum = moments;
  for (std::size_t i = 0; i < n; i += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      sum.c[l] += o[i + l];
      sum.x[l] += o[i + l] * x[i + l];
      sum.y[l] += o[i + l] * y[i + l];
    }
  }
  moments = sum;
}

/// Adds one row of n pixels.
KNOTREEL_MULTIVERSION
void add_row(const Shape& s, std::size_t n, const double* x, const double* y, const double* const* q,
             double* const* o, ShapeGradient& gradient) {
  fill_quantities(s, n, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4], o[5], o[6], o[7]);
  for (std::size_t k = 0; k < 4; ++k) {
    if (s.slopes[k].c < 1e29) add_moments(n, x, y, o[k], gradient.slopes[k]);
  }
  if (s.factor.x != 0 || s.factor.y != 0) add_moments(n, x, y, o[4], gradient.factor);
  for (std::size_t k = 0; k < 3; ++k) add_moments(n, x, y, o[5 + k], gradient.weights[k]);
}

/// q[i] += sum over channels of residual[channel][i] * control[channel].
KNOTREEL_MULTIVERSION
void project(const std::array<const float*, 4>& residual, const double* control, std::size_t channels,
             std::size_t n, double* __restrict q) {
  for (std::size_t c = 0; c < channels; ++c) {
    const float* __restrict r = residual[c];
    const double weight = control[c];
    for (std::size_t i = 0; i < n; ++i) q[i] += static_cast<double>(r[i]) * weight;
  }
}

/// Columns of the row at height y where a term can be positive, for pixels at most `slack` from their
/// centres.
std::pair<int, int> columns_of(const PieceTerm& term, double y, double slack, int width, double cell) {
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
  return {clamped(std::ceil(low / cell - 0.5)), clamped(std::floor(high / cell - 0.5) + 1)};
}

class Derivatives {
 public:
  Derivatives(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit,
              std::span<const std::uint8_t> wanted)
      : basis_(basis),
        image_(*pixels.image),
        fit_(fit),
        directions_(free_directions(basis.space().mesh(), wanted)),
        cell_width_(basis.space().mesh().width / image_.width),
        cell_height_(basis.space().mesh().height / image_.height),
        places_(image_.width, image_.height, cell_width_, cell_height_, pixels.places) {
    const auto channels = static_cast<std::size_t>(image_.channels);
    for (std::size_t c = 0; c < channels; ++c) {
      weighted_[c].resize(image_.pixel_count());
      for (std::size_t i = 0; i < weighted_[c].size(); ++i) {
        weighted_[c][i] =
            fit.residual[i * channels + c] * (pixels.weights.empty() ? 1.0F : pixels.weights[i]);
      }
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
    const std::vector<KnotIndex> knots = movable_knots(config);
    if (knots.empty()) return;
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
    for (const KnotIndex k : knots) {
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
      out.push_back(share);
    }
  }

 private:
  /// The knots of a config by which derivatives are taken.
  std::vector<KnotIndex> movable_knots(std::size_t config) const {
    const spline::SplineSpace& space = basis_.space();
    const spline::Config& c = space.configs()[config];
    std::vector<KnotIndex> knots;
    for (const auto corner : c.triangle) knots.push_back(space.cut().corners[corner].knot);
    for (int i = 0; i + 1 < space.degree(); ++i) {
      knots.push_back(space.cut().corners[c.inner[static_cast<std::size_t>(i)]].knot);
    }
    std::sort(knots.begin(), knots.end());
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    std::erase_if(knots, [&](KnotIndex k) { return directions_[k].count == 0; });
    return knots;
  }

  void sum_pixels(std::size_t config, std::span<const PieceTerm> terms, Vec2 origin,
                  const std::vector<Shape>& shapes, std::vector<ShapeGradient>& gradients) const {
    // All terms of a piece have the same box.
    const Vec2 low = terms.front().low;
    const Vec2 high = terms.front().high;
    const double slack = places_.reach(low, high);
    const auto clamped = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, double(n))); };
    const int top = clamped(std::ceil((low.y - slack) / cell_height_ - 0.5), image_.height);
    const int bottom = clamped(std::floor((high.y + slack) / cell_height_ - 0.5) + 1, image_.height);
    thread_local PixelRow row;
    for (int y = top; y < bottom; ++y) {
      int from = image_.width;
      int to = 0;
      for (const PieceTerm& term : terms) {
        const auto [first, last] =
            columns_of(term, (y + 0.5) * cell_height_, slack, image_.width, cell_width_);
        if (first >= last) continue;
        from = std::min(from, first);
        to = std::max(to, last);
      }
      if (from >= to) continue;
      fill_row(config, y, from, to, origin, slack > 0, row);
      const double* q[] = {row.q[0].data(), row.q[1].data(), row.q[2].data()};
      double* out[8];
      for (std::size_t k = 0; k < 8; ++k) out[k] = row.out[k].data();
      for (std::size_t t = 0; t < terms.size(); ++t) {
        add_row(shapes[t], row.x.size(), row.x.data(), row.y.data(), q, out, gradients[t]);
      }
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
      for (std::size_t i = 0; i < n; ++i) {
        row.x[i] = (from + 0.5) * cell_width_ - origin.x + static_cast<double>(i) * cell_width_;
      }
      std::fill_n(row.y.begin(), n, (y + 0.5) * cell_height_ - origin.y);
    }
    const auto channels = static_cast<std::size_t>(image_.channels);
    const std::size_t first =
        static_cast<std::size_t>(y) * std::size_t(image_.width) + static_cast<std::size_t>(from);
    std::array<const float*, 4> residual{};
    for (std::size_t c = 0; c < channels; ++c) residual[c] = weighted_[c].data() + first;
    const auto& functions = basis_.space().configs()[config].functions;
    for (std::size_t v = 0; v < 3; ++v) {
      if (functions[v] == spline::kNoFunction) continue;
      project(residual, fit_.control.data() + functions[v] * channels, channels, n, row.q[v].data());
    }
  }

  const spline::Basis& basis_;
  const image::Image& image_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
  double cell_width_;  ///< of a pixel in the domain
  double cell_height_;
  spline::Places places_;
  std::array<std::vector<float>, 4> weighted_;  ///< residual times weight, by channel
};

}  // namespace

std::vector<Vec2> knot_gradient(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit,
                                std::span<const std::uint8_t> wanted) {
  if (!wanted.empty() && wanted.size() != basis.space().mesh().knots.size()) {
    throw Error(ErrorKind::kInvalidArgument, "a gradient is wanted for some of the knots, one flag per knot");
  }
  const Derivatives derivatives(basis, pixels, fit, wanted);
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
