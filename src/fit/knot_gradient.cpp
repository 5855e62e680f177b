#include "knotreel/fit/knot_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/reference.h"
#include "spline/tent.h"

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

/// Columns of row y where a term can be positive; pixels at their centres.
std::pair<int, int> columns_of(const PieceTerm& term, double y, int width) {
  double low = term.low.x;
  double high = term.high.x;
  const auto clip = [&](const Affine& a) {
    if (a.nx == 0) return;
    const double zero = a.px - a.ny * (y - a.py) / a.nx;
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

/// Sum over the pixels [from, to) of tent * factor * sum_v weights[v] * q[v].
KNOTREEL_MULTIVERSION
double row_sum(const Piece& piece, const PieceTerm& term, const ResidualRow& row, double y, int from,
               int to) {
  struct Line {
    double slope, offset;
  };
  const double x0 = from + 0.5;
  const auto along = [&](const Affine& a) { return Line{a.nx, a.nx * (x0 - a.px) + a.ny * (y - a.py)}; };
  // Unused slopes are so high that they never rule.
  Line s[4] = {{0, 1e300}, {0, 1e300}, {0, 1e300}, {0, 1e300}};
  if (term.tent.slope_count == 0) s[0] = {0, term.tent.constant};
  for (int i = 0; i < term.tent.slope_count; ++i) s[i] = along(term.tent.slopes[static_cast<std::size_t>(i)]);
  const Line f = term.has_factor ? along(term.factor) : Line{0, 1};
  const Line w0 = along(piece.weights[0]);
  const Line w1 = along(piece.weights[1]);
  const Line w2 = along(piece.weights[2]);
  const double* __restrict q0 = row.q[0].data() + (from - row.begin);
  const double* __restrict q1 = row.q[1].data() + (from - row.begin);
  const double* __restrict q2 = row.q[2].data() + (from - row.begin);
  const int n = to - from;
  // Four sums side by side: the order is fixed, whatever the vector width.
  double sums[4] = {};
  const auto at = [&](int i) {
    const double x = i;
    double v = s[0].slope * x + s[0].offset;
    const double v1 = s[1].slope * x + s[1].offset;
    const double v2 = s[2].slope * x + s[2].offset;
    const double v3 = s[3].slope * x + s[3].offset;
    v = v1 < v ? v1 : v;
    v = v2 < v ? v2 : v;
    v = v3 < v ? v3 : v;
    v = v > 0 ? v : 0;
    const double share = (w0.slope * x + w0.offset) * q0[i] + (w1.slope * x + w1.offset) * q1[i] +
                         (w2.slope * x + w2.offset) * q2[i];
    return v * (f.slope * x + f.offset) * share;
  };
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    for (int l = 0; l < 4; ++l) sums[l] += at(i + l);
  }
  for (; i < n; ++i) sums[0] += at(i);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

class Differences {
 public:
  Differences(const spline::Basis& basis, const Pixels& pixels, const ColourFit& fit)
      : basis_(basis), pixels_(pixels), fit_(fit), directions_(free_directions(basis.space().mesh())) {}

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
    double sum = 0;
  };

  void add_variant(std::size_t config, const spline::KnotShift& shift, std::vector<Variant>& out) const {
    Variant v;
    v.piece = spline::make_shifted_piece(basis_.space(), config, shift, v.terms);
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
    const double margin = pixels_.places.empty() ? 0 : kPlaceMargin;
    const auto clamped = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, double(n))); };
    const int left = clamped(std::ceil(low.x - margin - 0.5), image.width);
    const int right = clamped(std::floor(high.x + margin - 0.5) + 1, image.width);
    const int top = clamped(std::ceil(low.y - margin - 0.5), image.height);
    const int bottom = clamped(std::floor(high.y + margin - 0.5) + 1, image.height);
    thread_local ResidualRow row;
    row.begin = left;
    for (auto& q : row.q) q.resize(static_cast<std::size_t>(std::max(0, right - left)));
    for (int y = top; y < bottom; ++y) {
      fill_row(config, y, left, right, row);
      const bool moved = any_moved(y, left, right);
      for (Variant& v : variants) {
        for (const PieceTerm& term : v.terms) {
          if (moved) {
            v.sum += moved_row_sum(v.piece, term, row, y, left, right);
            continue;
          }
          auto [from, to] = columns_of(term, y + 0.5, image.width);
          from = std::max(from, left);
          to = std::min(to, right);
          if (from < to) v.sum += row_sum(v.piece, term, row, y + 0.5, from, to);
        }
      }
    }
  }

  void fill_row(const spline::Config& config, int y, int left, int right, ResidualRow& row) const {
    const image::Image& image = *pixels_.image;
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t start = static_cast<std::size_t>(y) * image.row_size();
    for (std::size_t v = 0; v < 3; ++v) {
      double* q = row.q[v].data();
      std::fill(row.q[v].begin(), row.q[v].end(), 0.0);
      if (config.functions[v] == spline::kNoFunction) continue;
      const double* control = fit_.control.data() + config.functions[v] * channels;
      for (int x = left; x < right; ++x) {
        const float* r = fit_.residual.data() + start + static_cast<std::size_t>(x) * channels;
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c) sum += static_cast<double>(r[c]) * control[c];
        q[x - left] = sum;
      }
      if (pixels_.weights.empty()) continue;
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
      for (int x = left; x < right; ++x) {
        q[x - left] *= std::sqrt(static_cast<double>(pixels_.weights[pixel + static_cast<std::size_t>(x)]));
      }
    }
  }

  Vec2 place(int x, int y) const {
    return pixels_.places[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels_.image->width) +
                          static_cast<std::size_t>(x)];
  }

  bool any_moved(int y, int left, int right) const {
    if (pixels_.places.empty()) return false;
    for (int x = left; x < right; ++x) {
      if (place(x, y) != Vec2{x + 0.5, y + 0.5}) return true;
    }
    return false;
  }

  double moved_row_sum(const Piece& piece, const PieceTerm& term, const ResidualRow& row, int y, int left,
                       int right) const {
    const auto& mesh = basis_.space().mesh();
    double sum = 0;
    for (int x = left; x < right; ++x) {
      const Vec2 u = place(x, y);
      double v = spline::tent_value(term.tent, u, spline::inward_direction(u, mesh.width, mesh.height));
      if (v == 0) continue;
      if (term.has_factor) v *= term.factor(u);
      const auto i = static_cast<std::size_t>(x - left);
      sum += v * (piece.weights[0](u) * row.q[0][i] + piece.weights[1](u) * row.q[1][i] +
                  piece.weights[2](u) * row.q[2][i]);
    }
    return sum;
  }

  // Pixels whose places are farther away than this from their centres count at the rim of a config only.
  static constexpr double kPlaceMargin = 4;

  const spline::Basis& basis_;
  const Pixels& pixels_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
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
