// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/start.h"

#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/features/known_corners.h"
#include "vectorize/feature_budget.h"
#include "vectorize/first_knots.h"

namespace knotreel::vectorize {
namespace {

constexpr double kUsed = 0.4;           // of the control points, at most, if there is room
constexpr double kShareWithRoom = 0.6;  // for features then
// Line art is nothing but features: all of them are kept if the rest then needs next to nothing. Of the
// control points, at most, by estimates, which are up to a third too low there.
constexpr double kUsedByAll = 0.6;
constexpr double kNoLimit = 2;  // that pixels tell of is up to twice what straight lines need

/// Rather than soft edges and noise, which the smooth surface shows as well. Photographs, which are full of
/// those, hardly ever lose strong ones.
bool are_missed(const DroppedFeatures& dropped, bool drawing) {
  constexpr double kContrast = 100;  // levels, in the mean
  return dropped.strong || (drawing && dropped.mean_contrast() >= kContrast);
}

/// With features that may have this share of the control points or that. Two starts are never there at the
/// same time with all their pixels, of which a fine grid has many.
class Starts {
 public:
  Starts(const Grid& grid, const Options& options, std::size_t max_functions, RunLog& log)
      : grid_(grid),
        options_(options),
        max_functions_(max_functions),
        log_(log),
        found_(find_features(grid, options, log)) {}

  void grow(std::size_t max_functions) { max_functions_ = max_functions; }

  /// Nothing but features.
  std::unique_ptr<Start> mapped(double share) {
    auto start = std::make_unique<Start>();
    start->max_functions = max_functions_;
    Options options = options_;
    options.feature_share = log_.report.feature_share = share;
    log_.report.chains_over_budget = 0;
    map_features(grid_, found_, options, max_functions_, known_, log_, start->mapped);
    log_.report.strong_over_budget = start->mapped.dropped.strong;
    return start;
  }

  void place(Start& start) {
    start.target.emplace(make_target(grid_, start.mapped));
    log_.lap("resample");
    start.mesh.emplace(start.mapped.knots);
    // Knots go in one after the other, which takes one thread.
    parallel_invoke([&] { insert_first_knots(*start.target, max_functions_, options_, *start.mesh); },
                    [&] { start.samples.emplace(grid_.pixels, start.mapped, options_.half_rows); });
    log_.lap("place");
  }

  /// Of the control points, about.
  double used(const Start& start) const {
    return expected_functions(*start.mesh, options_.degree) / static_cast<double>(max_functions_);
  }

  /// With all features, if they and the rest then need little; or nothing.
  std::unique_ptr<Start> whole() {
    Report report = log_.report;
    const Progress progress = log_.progress;
    std::unique_ptr<Start> start = mapped(kNoLimit);
    if (!start->mapped.dropped.strong) {
      place(*start);
      if (used(*start) <= kUsedByAll) return start;
    }
    report.rounds = std::move(log_.report.rounds);  // with the time that this took
    log_.report = std::move(report);
    log_.progress = progress;
    return nullptr;
  }

 private:
  const Grid& grid_;
  const Options& options_;
  std::size_t max_functions_;
  RunLog& log_;
  features::FeatureChains found_;
  features::KnownCorners known_;
};

}  // namespace

std::unique_ptr<Start> make_start(const Grid& grid, const Options& options, const Bounds& bounds,
                                  RunLog& log) {
  Starts starts(grid, options, bounds.usual, log);
  const Progress at_first = log.progress;
  std::unique_ptr<Start> start = starts.mapped(options.feature_share);
  if (options.feature_share >= kShareWithRoom) {
    const bool drawing = features::is_drawing(grid.original);
    if (drawing && start->mapped.dropped.strong) {
      if (std::unique_ptr<Start> whole = starts.whole()) return whole;
    }
    if (are_missed(start->mapped.dropped, drawing) && bounds.with_features > bounds.usual) {
      start.reset();
      log.progress = at_first;
      starts.grow(bounds.with_features);
      start = starts.mapped(options.feature_share);
    }
  }
  starts.place(*start);
  if (options.feature_share < kShareWithRoom && log.report.chains_over_budget > 0 &&
      starts.used(*start) <= kUsed) {
    start.reset();
    log.progress = at_first;
    start = starts.mapped(kShareWithRoom);
    starts.place(*start);
  }
  return start;
}

}  // namespace knotreel::vectorize
