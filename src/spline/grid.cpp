#include <algorithm>
#include <cmath>
#include <limits>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/basis.h"
#include "spline/places.h"
#include "spline/tent.h"

/// Basis functions on a whole pixel grid, by spans: everything is linear along a row.
namespace knotreel::spline {

namespace {

/// Pixel columns of one term in one row.
struct Reach {
  std::int32_t begin;
  std::int32_t end;
};

/// A function of x alone: slope * (x - origin) + offset.
struct Linear {
  double slope;
  double origin;
  double offset;
};

Linear along_row(const Affine& a, double y) {
  return {a.nx, a.px, a.ny * (y - a.py)};
}

class Grid {
 public:
  Grid(const SplineSpace& space, int columns, int rows, int row_begin, int row_end)
      : columns_(columns),
        row_begin_(row_begin),
        row_end_(row_end),
        dx_(space.mesh().width / columns),
        dy_(space.mesh().height / rows),
        width_(space.mesh().width),
        height_(space.mesh().height) {}

  double x(std::int32_t column) const { return (column + 0.5) * dx_; }
  double y(std::int32_t row) const { return (row + 0.5) * dy_; }

  Vec2 inward(Vec2 u) const { return inward_direction(u, width_, height_); }

  /// Rows with centres within `margin` of the box of a term.
  Reach rows_of(const PieceTerm& term, double margin) const {
    const auto clamped = [&](double v) {
      return static_cast<std::int32_t>(
          std::clamp(v, static_cast<double>(row_begin_), static_cast<double>(row_end_)));
    };
    return {clamped(std::ceil((term.low.y - margin) / dy_ - 0.5)),
            clamped(std::floor((term.high.y + margin) / dy_ - 0.5) + 1)};
  }

  /// Columns whose pixels may lie in the support of a term in one row, if they are at most `slack` from their
  /// centres in each coordinate. Without slack: exact at walls, a little generous at slopes, where the tent
  /// is clamped at zero anyway.
  Reach columns_of(const PieceTerm& term, std::int32_t row, double slack) const {
    double low = term.low.x - slack;
    double high = term.high.x + slack;
    const auto clip = [&](const Affine& a) {
      Linear l = along_row(a, y(row));
      if (l.slope == 0) return;
      l.offset += slack * (std::abs(a.nx) + std::abs(a.ny));
      const double zero = l.origin - l.offset / l.slope;
      if (l.slope > 0) low = std::max(low, zero);
      if (l.slope < 0) high = std::min(high, zero);
    };
    const Tent& tent = term.tent;
    for (int i = 0; i < tent.slope_count; ++i) clip(tent.slopes[static_cast<std::size_t>(i)]);
    for (int i = 0; i < tent.wall_count; ++i) clip(tent.walls[static_cast<std::size_t>(i)]);
    // One column more on each side: rounding of the division, and points on a wall.
    const auto clamped = [&](double v) {
      return static_cast<std::int32_t>(std::clamp(v, 0.0, static_cast<double>(columns_)));
    };
    Reach reach{clamped(std::ceil(low / dx_ - 1.5)), clamped(std::floor(high / dx_ + 0.5) + 1)};
    if (tent.wall_count == 0 || slack > 0) return reach;
    while (reach.begin < reach.end && !inside(tent, reach.begin, row)) ++reach.begin;
    while (reach.begin < reach.end && !inside(tent, reach.end - 1, row)) --reach.end;
    return reach;
  }

 private:
  bool inside(const Tent& tent, std::int32_t column, std::int32_t row) const {
    const Vec2 u{x(column), y(row)};
    const Vec2 direction = inward(u);
    for (int i = 0; i < tent.wall_count; ++i) {
      if (!inside_wall(tent.walls[static_cast<std::size_t>(i)], u, direction)) return false;
    }
    return true;
  }

  std::int32_t columns_;
  std::int32_t row_begin_;
  std::int32_t row_end_;
  double dx_;
  double dy_;
  double width_;
  double height_;
};

/// The three shares of one term in one row.
struct RowTask {
  std::array<Linear, 4> slopes;
  int slope_count;
  double constant;
  Linear factor;
  std::array<Linear, 3> weights;
  std::array<double*, 3> out;
};

[[gnu::always_inline]] inline double at(const Linear& l, double x) {
  return l.slope * (x - l.origin) + l.offset;
}

/// S: number of slopes, 0 for the constant tents of degree 1. Inlined into each version of add_row.
template <int S, bool Factor>
[[gnu::always_inline]] inline void row_loop(const RowTask& task, const double* __restrict x, std::int32_t n) {
  const std::array<Linear, 4> s = task.slopes;
  const std::array<Linear, 3> w = task.weights;
  const Linear f = task.factor;
  double* __restrict out0 = task.out[0];
  double* __restrict out1 = task.out[1];
  double* __restrict out2 = task.out[2];
  for (std::int32_t i = 0; i < n; ++i) {
    double v = task.constant;
    if constexpr (S > 0) v = at(s[0], x[i]);
    if constexpr (S > 1) v = at(s[1], x[i]) < v ? at(s[1], x[i]) : v;
    if constexpr (S > 2) v = at(s[2], x[i]) < v ? at(s[2], x[i]) : v;
    if constexpr (S > 3) v = at(s[3], x[i]) < v ? at(s[3], x[i]) : v;
    v = v > 0 ? v : 0;
    if constexpr (Factor) v *= at(f, x[i]);
    out0[i] += v * at(w[0], x[i]);
    out1[i] += v * at(w[1], x[i]);
    out2[i] += v * at(w[2], x[i]);
  }
}

template <bool Factor>
[[gnu::always_inline]] inline void row_by_slopes(const RowTask& task, const double* x, std::int32_t n) {
  switch (task.slope_count) {
    case 0:
      return row_loop<0, Factor>(task, x, n);
    case 1:
      return row_loop<1, Factor>(task, x, n);
    case 2:
      return row_loop<2, Factor>(task, x, n);
    case 3:
      return row_loop<3, Factor>(task, x, n);
    default:
      return row_loop<4, Factor>(task, x, n);
  }
}

/// Adds the shares to the function rows, for n pixels whose columns are at x[0..n).
KNOTREEL_MULTIVERSION
void add_row(const RowTask& task, bool has_factor, const double* x, std::int32_t n) {
  if (has_factor) {
    row_by_slopes<true>(task, x, n);
  } else {
    row_by_slopes<false>(task, x, n);
  }
}

RowTask make_task(const Piece& piece, const PieceTerm& term, double y) {
  RowTask task{};
  task.slope_count = term.tent.slope_count;
  task.constant = term.tent.constant;
  for (int s = 0; s < task.slope_count; ++s) {
    task.slopes[static_cast<std::size_t>(s)] = along_row(term.tent.slopes[static_cast<std::size_t>(s)], y);
  }
  task.factor = along_row(term.factor, y);
  for (std::size_t i = 0; i < 3; ++i) task.weights[i] = along_row(piece.weights[i], y);
  return task;
}

/// Where every term reaches, row by row.
struct Reaches {
  std::vector<std::size_t> begin;   ///< per term, into reaches
  std::vector<std::int32_t> first;  ///< first row per term
  std::vector<float> slack;         ///< per term: how far pixels near it are from their centres
  std::vector<Reach> reaches;
};

Reaches find_reaches(const PieceSet& set, const Grid& grid, const Places& places) {
  const std::size_t terms = set.terms.size();
  Reaches r;
  r.begin.assign(terms + 1, 0);
  r.first.resize(terms);
  r.slack.resize(terms);
  for (std::size_t t = 0; t < terms; ++t) {
    const double slack = places.reach(set.terms[t].low, set.terms[t].high);
    r.slack[t] = std::nextafter(static_cast<float>(slack), std::numeric_limits<float>::max());
    if (slack == 0) r.slack[t] = 0;
    const Reach rows = grid.rows_of(set.terms[t], static_cast<double>(r.slack[t]));
    r.first[t] = rows.begin;
    r.begin[t + 1] = r.begin[t] + static_cast<std::size_t>(std::max(0, rows.end - rows.begin));
  }
  r.reaches.resize(r.begin.back());
  constexpr std::size_t kBlock = 256;
  parallel_for((terms + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t t = block * kBlock; t < std::min(terms, (block + 1) * kBlock); ++t) {
      for (std::size_t i = r.begin[t]; i < r.begin[t + 1]; ++i) {
        const auto y = r.first[t] + static_cast<std::int32_t>(i - r.begin[t]);
        // Rows beside the support show up as empty or reversed.
        const Reach reach = grid.columns_of(set.terms[t], y, static_cast<double>(r.slack[t]));
        r.reaches[i] = {reach.begin, std::max(reach.begin, reach.end)};
      }
    }
  });
  return r;
}

/// Lays out the rows of all functions: the hull, per row, of what their terms reach.
GridValues lay_out(const SplineSpace& space, const PieceSet& set, const Reaches& reaches,
                   std::int32_t columns) {
  const std::size_t n = space.function_count();
  std::vector<std::int32_t> low(n, std::numeric_limits<std::int32_t>::max());
  std::vector<std::int32_t> high(n, 0);
  const auto for_terms = [&](auto&& visit) {
    for (const Piece& piece : set.pieces) {
      for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
        for (const FunctionIndex f : piece.functions) {
          if (f != kNoFunction) visit(f, t);
        }
      }
    }
  };
  for_terms([&](FunctionIndex f, std::uint32_t t) {
    const auto count = static_cast<std::int32_t>(reaches.begin[t + 1] - reaches.begin[t]);
    if (count == 0) return;
    low[f] = std::min(low[f], reaches.first[t]);
    high[f] = std::max(high[f], reaches.first[t] + count);
  });
  GridValues grid;
  grid.row_begin.reserve(n + 1);
  grid.row_begin.push_back(0);
  for (std::size_t f = 0; f < n; ++f) {
    for (std::int32_t y = low[f]; y < high[f]; ++y) grid.rows.push_back({y, columns, 0, 0});
    grid.row_begin.push_back(grid.rows.size());
  }
  for_terms([&](FunctionIndex f, std::uint32_t t) {
    for (std::size_t i = reaches.begin[t]; i < reaches.begin[t + 1]; ++i) {
      if (reaches.reaches[i].begin >= reaches.reaches[i].end) continue;
      const auto y = reaches.first[t] + static_cast<std::int32_t>(i - reaches.begin[t]);
      GridValues::Row& row = grid.rows[grid.row_begin[f] + static_cast<std::size_t>(y - low[f])];
      row.x_begin = std::min(row.x_begin, reaches.reaches[i].begin);
      row.x_end = std::max(row.x_end, reaches.reaches[i].end);
    }
  });
  std::size_t offset = GridValues::kMargin;
  for (GridValues::Row& row : grid.rows) {
    row.x_begin = std::min(row.x_begin, row.x_end);
    row.offset = offset;
    offset += static_cast<std::size_t>(row.x_end - row.x_begin);
  }
  grid.values.assign(offset + GridValues::kMargin, 0.0);
  return grid;
}

/// S: number of slopes, 0 for the constant tents of degree 1. Inlined into each version of add_places.
template <int S, bool Walls, bool Factor>
[[gnu::always_inline]] inline bool places_loop(const Piece& piece, const PieceTerm& term,
                                               const std::array<double*, 3>& out, const double* __restrict x,
                                               const double* __restrict y, std::int32_t n) {
  const std::array<Affine, 4> s = term.tent.slopes;
  // Missing walls are far away.
  std::array<Affine, 3> walls{};
  std::array<double, 3> inside{1, 1, 1};
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i) {
    walls[i] = term.tent.walls[i];
    inside[i] = 0;
  }
  const double constant = term.tent.constant;
  const Affine factor = term.factor;
  const std::array<Affine, 3> w = piece.weights;
  double* __restrict out0 = out[0];
  double* __restrict out1 = out[1];
  double* __restrict out2 = out[2];
  double nearest = 1;
  for (std::int32_t i = 0; i < n; ++i) {
    const double ux = x[i];
    const double uy = y[i];
    const auto value = [&](const Affine& a) { return a.nx * (ux - a.px) + a.ny * (uy - a.py); };
    double v = constant;
    if constexpr (S > 0) v = value(s[0]);
    if constexpr (S > 1) v = value(s[1]) < v ? value(s[1]) : v;
    if constexpr (S > 2) v = value(s[2]) < v ? value(s[2]) : v;
    if constexpr (S > 3) v = value(s[3]) < v ? value(s[3]) : v;
    v = v > 0 ? v : 0;
    if constexpr (Walls) {
      const double d0 = value(walls[0]) + inside[0];
      const double d1 = value(walls[1]) + inside[1];
      const double d2 = value(walls[2]) + inside[2];
      const double d01 = d1 < d0 ? d1 : d0;
      const double d = d2 < d01 ? d2 : d01;
      v = d > 0 ? v : 0;
      const double distance = d < 0 ? -d : d;
      nearest = distance < nearest ? distance : nearest;
    }
    if constexpr (Factor) v *= value(factor);
    double w0 = value(w[0]);
    double w1 = value(w[1]);
    double w2 = value(w[2]);
    if constexpr (S == 0) {
      // A point counts as inside the closed face, so a negative coordinate is the tolerance of a wall.
      w0 = w0 < 0 ? 0 : w0;
      w1 = w1 < 0 ? 0 : w1;
      w2 = w2 < 0 ? 0 : w2;
    }
    out0[i] += v * w0;
    out1[i] += v * w1;
    out2[i] += v * w2;
  }
  return nearest <= kOnWall;
}

template <bool Walls, bool Factor>
[[gnu::always_inline]] inline bool places_by_slopes(const Piece& piece, const PieceTerm& term,
                                                    const std::array<double*, 3>& out, const double* x,
                                                    const double* y, std::int32_t n) {
  switch (term.tent.slope_count) {
    case 0:
      return places_loop<0, Walls, Factor>(piece, term, out, x, y, n);
    case 1:
      return places_loop<1, Walls, Factor>(piece, term, out, x, y, n);
    case 2:
      return places_loop<2, Walls, Factor>(piece, term, out, x, y, n);
    case 3:
      return places_loop<3, Walls, Factor>(piece, term, out, x, y, n);
    default:
      return places_loop<4, Walls, Factor>(piece, term, out, x, y, n);
  }
}

/// Values of one term at n places with its three weights; the sign of a place exactly on a wall is left open.
/// @return whether there was such a place.
KNOTREEL_MULTIVERSION
bool add_places(const Piece& piece, const PieceTerm& term, const std::array<double*, 3>& out, const double* x,
                const double* y, std::int32_t n) {
  if (term.tent.wall_count > 0) {
    return term.has_factor ? places_by_slopes<true, true>(piece, term, out, x, y, n)
                           : places_by_slopes<true, false>(piece, term, out, x, y, n);
  }
  return term.has_factor ? places_by_slopes<false, true>(piece, term, out, x, y, n)
                         : places_by_slopes<false, false>(piece, term, out, x, y, n);
}

/// The same with places on walls on their proper sides, one by one.
void add_places_one_by_one(const Piece& piece, const PieceTerm& term, const std::array<double*, 3>& out,
                           const Grid& grid, const double* x, const double* y, std::int32_t n) {
  for (std::int32_t i = 0; i < n; ++i) {
    const Vec2 u{x[i], y[i]};
    double v = tent_value(term.tent, u, grid.inward(u));
    if (v == 0) continue;
    if (term.has_factor) v *= term.factor(u);
    const double lowest = term.tent.slope_count == 0 ? 0 : -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) out[k][i] += v * std::max(piece.weights[k](u), lowest);
  }
}

void add_moved_row(const Piece& piece, const PieceTerm& term, const std::array<double*, 3>& out,
                   const Grid& grid, const double* x, const double* y, std::int32_t n) {
  thread_local std::array<std::vector<double>, 3> before;
  if (term.tent.wall_count > 0) {
    for (std::size_t k = 0; k < 3; ++k) before[k].assign(out[k], out[k] + n);
  }
  if (!add_places(piece, term, out, x, y, n) || term.tent.wall_count == 0) return;
  for (std::size_t k = 0; k < 3; ++k) std::copy_n(before[k].begin(), n, out[k]);
  add_places_one_by_one(piece, term, out, grid, x, y, n);
}

/// Adds up all terms in the rows [begin, end).
void add_rows(const PieceSet& set, const Reaches& reaches, const Grid& grid, const Places& places,
              const std::vector<double>& x, std::int32_t begin, std::int32_t end, GridValues& result) {
  std::vector<double> nowhere(x.size());  // shares of functions that vanish
  for (const Piece& piece : set.pieces) {
    for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
      const auto count = static_cast<std::int32_t>(reaches.begin[t + 1] - reaches.begin[t]);
      const std::int32_t from = std::max(begin, reaches.first[t]);
      const std::int32_t to = std::min(end, reaches.first[t] + count);
      for (std::int32_t y = from; y < to; ++y) {
        const Reach reach =
            reaches.reaches[reaches.begin[t] + static_cast<std::size_t>(y - reaches.first[t])];
        if (reach.begin >= reach.end) continue;
        std::array<double*, 3> out;
        for (std::size_t v = 0; v < 3; ++v) {
          const FunctionIndex f = piece.functions[v];
          out[v] = nowhere.data();
          if (f == kNoFunction) continue;
          const std::size_t first = result.row_begin[f];
          const GridValues::Row& row =
              result.rows[first + static_cast<std::size_t>(y - result.rows[first].y)];
          out[v] = result.values.data() + row.offset + (reach.begin - row.x_begin);
        }
        const PieceTerm& term = set.terms[t];
        // Near moved pixels there are rows of pixels that are not; only their columns at walls would not do.
        const bool moved =
            reaches.slack[t] > 0 && (term.tent.wall_count > 0 || places.moved(y, reach.begin, reach.end));
        if (moved) {
          add_moved_row(piece, term, out, grid, places.x(y) + reach.begin, places.y(y) + reach.begin,
                        reach.end - reach.begin);
        } else {
          RowTask task = make_task(piece, term, grid.y(y));
          task.out = out;
          add_row(task, term.has_factor, x.data() + reach.begin, reach.end - reach.begin);
        }
      }
    }
  }
}

/// The pieces of the wanted functions only.
PieceSet pieces_of(const PieceSet& set, std::span<const std::uint8_t> wanted) {
  PieceSet some;
  for (Piece piece : set.pieces) {
    bool any = false;
    for (FunctionIndex& f : piece.functions) {
      if (f != kNoFunction && !wanted[f]) f = kNoFunction;
      any = any || f != kNoFunction;
    }
    if (!any) continue;
    const auto terms = std::span(set.terms).subspan(piece.term_begin, piece.term_end - piece.term_begin);
    piece.term_begin = static_cast<std::uint32_t>(some.terms.size());
    some.terms.insert(some.terms.end(), terms.begin(), terms.end());
    piece.term_end = static_cast<std::uint32_t>(some.terms.size());
    some.pieces.push_back(piece);
  }
  return some;
}

}  // namespace

GridValues Basis::evaluate_grid(int columns, int rows) const {
  return evaluate_grid_rows(columns, rows, 0, rows);
}

GridValues Basis::evaluate_grid_rows(int columns, int rows, int row_begin, int row_end) const {
  return evaluate_pixels(columns, rows, {}, row_begin, row_end);
}

GridValues Basis::evaluate_pixels(int columns, int rows, std::span<const Vec2> places, int row_begin,
                                  int row_end, std::span<const std::uint8_t> wanted) const {
  const PieceSet some = wanted.empty() ? PieceSet{} : pieces_of(pieces_, wanted);
  const PieceSet& pieces = wanted.empty() ? pieces_ : some;
  const Grid grid(*space_, columns, rows, row_begin, row_end);
  const Places moved(columns, rows, space_->mesh().width / columns, space_->mesh().height / rows, places);
  const Reaches reaches = find_reaches(pieces, grid, moved);
  GridValues result = lay_out(*space_, pieces, reaches, columns);
  std::vector<double> x(static_cast<std::size_t>(columns));
  for (std::int32_t c = 0; c < columns; ++c) x[static_cast<std::size_t>(c)] = grid.x(c);
  // Few bands, because each looks at all terms.
  const int band = std::max(16, (row_end - row_begin + 7) / 8);
  parallel_for(static_cast<std::size_t>((row_end - row_begin + band - 1) / band), [&](std::size_t b) {
    const int begin = row_begin + static_cast<int>(b) * band;
    add_rows(pieces, reaches, grid, moved, x, begin, std::min(row_end, begin + band), result);
  });
  return result;
}

}  // namespace knotreel::spline
