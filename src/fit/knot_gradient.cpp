#include "knotreel/fit/knot_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/multiversion.h"
#include "fit/region_moments.h"
#include "fit/shape_gradient.h"
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

constexpr double kStep = 1e-5;        // pixels, for differences of coefficients
constexpr std::size_t kBatch = 512;   // pixels that are added at a time
constexpr int kBandPixels = 1 << 15;  // of running sums: 3 MB, so that they stay in the cache
constexpr int kBandRows = 32;         // at least: all configs are looked at for each band

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

/// A term without a factor by the regions where each of its slopes rules.
class Regions {
 public:
  Regions(const Shape& shape, int left, int right, double cell_width, Vec2 origin)
      : count_(shape.slope_count) {
    for (std::size_t k = 0; k < count_; ++k) {
      Region region(left, right, cell_width, origin);
      for (std::size_t j = 0; j < count_; ++j) {
        if (j != k) region.cut(shape.slopes[j] - shape.slopes[k]);
      }
      if (shape.slopes[k].x != 0 || shape.slopes[k].y != 0) region.cut(shape.slopes[k]);
      for (std::size_t i = 0; i < shape.wall_count; ++i) region.cut(shape.walls[i]);
      regions_[k] = region;
    }
  }

  void add_row(const RunningSums::Sums* sums, double y) {
    for (std::size_t k = 0; k < count_; ++k) regions_[k].add_row(sums, y, moments_[k]);
  }

  /// @param control points of the three functions; of functions that vanish: none.
  void add_to(const Shape& shape, const std::array<std::span<const double>, 3>& control,
              ShapeGradient& gradient) const {
    for (std::size_t k = 0; k < count_; ++k) {
      for (std::size_t v = 0; v < 3; ++v) {
        const ProductMoments q(moments_[k], control[v]);
        add(gradient.slopes[k], q.times(shape.weights[v]));
        add(gradient.weights[v], q.times(shape.slopes[k]));
      }
    }
  }

 private:
  /// Moments of the residual times a control point.
  struct ProductMoments {
    double one = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    ProductMoments(const Moments& m, std::span<const double> control) {
      for (std::size_t c = 0; c < control.size(); ++c) {
        one += control[c] * m.one[c];
        x += control[c] * m.x[c];
        y += control[c] * m.y[c];
        xx += control[c] * m.xx[c];
        xy += control[c] * m.xy[c];
        yy += control[c] * m.yy[c];
      }
    }

    /// Moments of order 0 and 1 of the product with a plane.
    Plane times(const Plane& p) const {
      return {p.c * one + p.x * x + p.y * y, p.c * x + p.x * xx + p.y * xy, p.c * y + p.x * xy + p.y * yy};
    }
  };

  static void add(Plane& sum, const Plane& p) { sum = {sum.c + p.c, sum.x + p.x, sum.y + p.y}; }

  std::size_t count_;
  std::array<Region, 4> regions_{};
  std::array<Moments, 4> moments_{};
};

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

/// Runs of pixels that are not at their centres, by row.
class MovedRuns {
 public:
  struct Run {
    int begin;
    int end;
  };

  MovedRuns(const spline::Places& places, const image::Image& image, double cell_width, double cell_height) {
    first_.push_back(0);
    for (int y = 0; y < image.height; ++y) {
      const double centre_y = (y + 0.5) * cell_height;
      bool before = false;
      for (int x = 0; x < image.width; ++x) {
        const bool moved = places.x(y)[x] != (x + 0.5) * cell_width || places.y(y)[x] != centre_y;
        if (moved && !before) runs_.push_back({x, x});
        if (moved) runs_.back().end = x + 1;
        before = moved;
      }
      first_.push_back(runs_.size());
    }
  }

  std::span<const Run> row(int y) const {
    const auto i = static_cast<std::size_t>(y);
    return std::span(runs_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

  /// Those that meet some columns.
  std::span<const Run> row(int y, Run columns) const {
    const std::span<const Run> all = row(y);
    const auto from =
        std::partition_point(all.begin(), all.end(), [&](const Run& r) { return r.end <= columns.begin; });
    const auto to =
        std::partition_point(from, all.end(), [&](const Run& r) { return r.begin < columns.end; });
    return {from, to};
  }

 private:
  std::vector<Run> runs_;
  std::vector<std::size_t> first_;
};

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
    weighted_.resize(channels);
    for (std::size_t c = 0; c < channels; ++c) {
      weighted_[c].resize(image_.pixel_count());
      for (std::size_t i = 0; i < weighted_[c].size(); ++i) {
        weighted_[c][i] =
            fit.residual[i * channels + c] * (pixels.weights.empty() ? 1.0F : pixels.weights[i]);
      }
    }
    still_ = weighted_;
    if (pixels.places.empty()) return;
    moved_.emplace(places_, image_, cell_width_, cell_height_);
    for (int y = 0; y < image_.height; ++y) {
      for (const MovedRuns::Run& run : moved_->row(y)) {
        for (auto& channel : still_)
          std::fill_n(channel.begin() + y * image_.width + run.begin, run.end - run.begin, 0.0F);
      }
    }
  }

  double cell_width() const { return cell_width_; }

  /// Residual times weight, by channel; zero for pixels that are not at their centres.
  std::span<const std::vector<float>> still() const { return still_; }

  /// Adds the pixels of a band of rows to the gradient by the planes of the terms of one config.
  void add_band(std::size_t config, const RunningSums& sums, std::span<ShapeGradient> by_term) const {
    const Piece& piece = basis_.pieces().pieces[config];
    if (piece.term_begin == piece.term_end) return;
    const PieceTerm& term = basis_.pieces().terms[piece.term_begin];
    const double slack = places_.widest();
    if (term.high.y + slack < sums.begin() * cell_height_ || term.low.y - slack > sums.end() * cell_height_)
      return;
    if (movable_knots(config).count == 0) return;
    sum_pixels(config, sums, by_term.subspan(piece.term_begin, piece.term_end - piece.term_begin));
  }

  struct Share {
    KnotIndex knot;
    Vec2 value;
  };

  /// d/dt of sum over pixels of r . S_config for the knots of one config.
  void add_shares(std::size_t config, std::span<const ShapeGradient> by_term, std::vector<Share>& out) const {
    const Piece& piece = basis_.pieces().pieces[config];
    if (piece.term_begin == piece.term_end) return;
    const MovableKnots knots = movable_knots(config);
    if (knots.count == 0) return;
    const std::span<const PieceTerm> terms = terms_of(piece);
    const auto gradients = by_term.subspan(piece.term_begin, terms.size());
    const spline::SplineSpace& space = basis_.space();
    const Vec2 origin = origin_of(config);
    thread_local std::vector<Shape> shapes;
    shapes.clear();
    for (const PieceTerm& term : terms) shapes.push_back(shape_of(piece, term, origin));

    thread_local std::vector<PieceTerm> shifted;
    for (std::size_t i = 0; i < knots.count; ++i) {
      const KnotIndex k = knots.knots[i];
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
  Vec2 origin_of(std::size_t config) const {
    return basis_.space().position(basis_.space().configs()[config].triangle[0]);
  }

  std::span<const PieceTerm> terms_of(const Piece& piece) const {
    return std::span(basis_.pieces().terms).subspan(piece.term_begin, piece.term_end - piece.term_begin);
  }

  /// The knots of a config by which derivatives are taken, each once.
  struct MovableKnots {
    std::array<KnotIndex, 5> knots{};
    std::size_t count = 0;
  };

  MovableKnots movable_knots(std::size_t config) const {
    const spline::SplineSpace& space = basis_.space();
    const spline::Config& c = space.configs()[config];
    MovableKnots result;
    const auto add = [&](spline::CornerIndex corner) {
      const KnotIndex k = space.cut().corners[corner].knot;
      const auto known = std::span(result.knots).first(result.count);
      if (directions_[k].count == 0 || std::find(known.begin(), known.end(), k) != known.end()) return;
      result.knots[result.count++] = k;
    };
    for (const auto corner : c.triangle) add(corner);
    for (int i = 0; i + 1 < space.degree(); ++i) add(c.inner[static_cast<std::size_t>(i)]);
    return result;
  }

  /// Pixels at their centres are summed by regions, moved ones one by one.
  void sum_pixels(std::size_t config, const RunningSums& sums, std::span<ShapeGradient> gradients) const {
    const Piece& piece = basis_.pieces().pieces[config];
    const std::span<const PieceTerm> terms = terms_of(piece);
    // All terms of a piece have the same box.
    const Vec2 low = terms.front().low;
    const Vec2 high = terms.front().high;
    const double slack = places_.reach(low, high);
    const auto first = [slack](double v, double cell, int from, int to) {
      return static_cast<int>(std::clamp(std::ceil((v - slack) / cell - 0.5), double(from), double(to)));
    };
    const auto last = [slack](double v, double cell, int from, int to) {
      return static_cast<int>(std::clamp(std::floor((v + slack) / cell - 0.5) + 1, double(from), double(to)));
    };
    const int top = first(low.y, cell_height_, sums.begin(), sums.end());
    const int bottom = last(high.y, cell_height_, sums.begin(), sums.end());
    const int left = first(low.x, cell_width_, 0, image_.width);
    const int right = last(high.x, cell_width_, 0, image_.width);
    if (top >= bottom || left >= right) return;

    const Vec2 origin = origin_of(config);
    thread_local std::vector<Shape> shapes;
    shapes.clear();
    for (const PieceTerm& term : terms) shapes.push_back(shape_of(piece, term, origin));
    std::optional<Regions> regions;
    if (!terms.front().has_factor) regions.emplace(shapes.front(), left, right, cell_width_, origin);
    thread_local PixelBatch batch;
    batch.clear();
    for (int y = top; y < bottom; ++y) {
      if (regions) regions->add_row(sums.row(y), (y + 0.5) * cell_height_ - origin.y);
      append_row(y, {left, right}, slack, terms, !regions, origin, batch);
      if (batch.x.size() >= kBatch) add_batch(config, shapes, batch, gradients);
    }
    if (regions) regions->add_to(shapes.front(), controls_of(config), gradients.front());
    if (!batch.x.empty()) add_batch(config, shapes, batch, gradients);
  }

  std::array<std::span<const double>, 3> controls_of(std::size_t config) const {
    const auto channels = static_cast<std::size_t>(image_.channels);
    std::array<std::span<const double>, 3> result;
    for (std::size_t v = 0; v < 3; ++v) {
      const spline::FunctionIndex f = basis_.space().configs()[config].functions[v];
      if (f != spline::kNoFunction) result[v] = std::span(fit_.control).subspan(f * channels, channels);
    }
    return result;
  }

  /// Appends the pixels of a row where some term may be positive: all of them, or those that are moved.
  /// @param box columns outside of which there are none.
  void append_row(int y, MovedRuns::Run box, double slack, std::span<const PieceTerm> terms, bool all,
                  Vec2 origin, PixelBatch& batch) const {
    if (!all && slack == 0) return;
    const std::span<const MovedRuns::Run> runs = all ? std::span(&box, 1) : moved_->row(y, box);
    if (runs.empty()) return;
    const MovedRuns::Run columns = columns_of_any(terms, y, slack);
    for (const MovedRuns::Run& run : runs) {
      const int from = std::max(run.begin, columns.begin);
      const int to = std::min(run.end, columns.end);
      if (from < to) append_run(y, {from, to}, origin, batch);
    }
  }

  MovedRuns::Run columns_of_any(std::span<const PieceTerm> terms, int y, double slack) const {
    MovedRuns::Run columns{image_.width, 0};
    for (const PieceTerm& term : terms) {
      const auto [first, last] = columns_of(term, (y + 0.5) * cell_height_, slack, image_.width, cell_width_);
      if (first >= last) continue;
      columns.begin = std::min(columns.begin, first);
      columns.end = std::max(columns.end, last);
    }
    return columns;
  }

  void append_run(int y, MovedRuns::Run run, Vec2 origin, PixelBatch& batch) const {
    const std::size_t before = batch.x.size();
    const auto n = static_cast<std::size_t>(run.end - run.begin);
    batch.x.resize(before + n);
    batch.y.resize(before + n);
    for (std::size_t i = 0; i < n; ++i) {
      const int x = run.begin + static_cast<int>(i);
      batch.x[before + i] = (moved_ ? places_.x(y)[x] : (x + 0.5) * cell_width_) - origin.x;
      batch.y[before + i] = (moved_ ? places_.y(y)[x] : (y + 0.5) * cell_height_) - origin.y;
    }
    const std::size_t row = static_cast<std::size_t>(y) * std::size_t(image_.width);
    for (std::size_t c = 0; c < weighted_.size(); ++c) {
      const float* r = weighted_[c].data() + row;
      batch.residual[c].insert(batch.residual[c].end(), r + run.begin, r + run.end);
    }
  }

  /// Adds the pixels of a batch and clears it.
  void add_batch(std::size_t config, const std::vector<Shape>& shapes, PixelBatch& batch,
                 std::span<ShapeGradient> gradients) const {
    batch.pad();
    const std::size_t n = batch.x.size();
    std::array<const float*, 4> residual{};
    for (std::size_t c = 0; c < 4; ++c) residual[c] = batch.residual[c].data();
    const auto controls = controls_of(config);
    for (std::size_t v = 0; v < 3; ++v)
      project(residual, controls[v].data(), controls[v].size(), n, batch.q[v].data());
    const double* q[] = {batch.q[0].data(), batch.q[1].data(), batch.q[2].data()};
    double* out[8];
    for (std::size_t k = 0; k < 8; ++k) out[k] = batch.out[k].data();
    for (std::size_t t = 0; t < shapes.size(); ++t) {
      ShapeMoments moments;
      add_pixels(shapes[t], n, batch.x.data(), batch.y.data(), q, out, moments);
      add_to(gradients[t], moments);
    }
    batch.clear();
  }

  const spline::Basis& basis_;
  const image::Image& image_;
  const ColourFit& fit_;
  std::vector<Directions> directions_;
  double cell_width_;  ///< of a pixel in the domain
  double cell_height_;
  spline::Places places_;
  std::optional<MovedRuns> moved_;
  std::vector<std::vector<float>> weighted_;  ///< residual times weight, by channel
  std::vector<std::vector<float>> still_;     ///< the same, zero for moved pixels
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
  const std::size_t blocks = (configs + kBlock - 1) / kBlock;
  const auto for_configs = [&](auto&& visit) {
    parallel_for(blocks, [&](std::size_t b) {
      for (std::size_t c = b * kBlock; c < std::min(configs, (b + 1) * kBlock); ++c) visit(b, c);
    });
  };
  std::vector<ShapeGradient> by_term(basis.pieces().terms.size());
  const int rows = std::max(kBandRows, kBandPixels / pixels.image->width);
  for (int begin = 0; begin < pixels.image->height; begin += rows) {
    const RunningSums sums(derivatives.still(), pixels.image->width, begin,
                           std::min(pixels.image->height, begin + rows), derivatives.cell_width());
    for_configs([&](std::size_t, std::size_t c) { derivatives.add_band(c, sums, by_term); });
  }
  std::vector<std::vector<Derivatives::Share>> shares(blocks);
  for_configs([&](std::size_t b, std::size_t c) { derivatives.add_shares(c, by_term, shares[b]); });
  std::vector<Vec2> gradient(basis.space().mesh().knots.size());
  for (const auto& block : shares) {
    for (const auto& s : block) gradient[s.knot] = gradient[s.knot] - 2 * s.value;
  }
  return gradient;
}

}  // namespace knotreel::fit
