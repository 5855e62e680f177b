#include "vectorize/start.h"

#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/features/flat_share.h"
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

std::unique_ptr<Start> start_with(const Grid& grid, const Options& options, std::size_t max_functions,
                                  RunLog& log) {
  auto start = std::make_unique<Start>();
  log.report.feature_share = options.feature_share;
  map_features(grid, options, max_functions, log, start->mapped);
  log.report.strong_over_budget = start->mapped.over_share;
  start->target.emplace(make_target(grid.pixels, start->mapped));
  log.lap("resample");
  start->mesh.emplace(start->mapped.knots);
  // Knots go in one after the other, which takes one thread.
  parallel_invoke([&] { insert_first_knots(*start->target, max_functions, options, *start->mesh); },
                  [&] { start->samples.emplace(grid.pixels, start->mapped, options.half_rows); });
  log.lap("place");
  return start;
}

std::unique_ptr<Start> start_with_share(double share, const Grid& grid, Options options,
                                        std::size_t max_functions, RunLog& log) {
  options.feature_share = share;
  log.report.chains = log.report.feature_pixels = log.report.chains_over_budget = 0;
  return start_with(grid, options, max_functions, log);
}

}  // namespace

std::unique_ptr<Start> make_start(const Grid& grid, const Options& options, std::size_t max_functions,
                                  RunLog& log) {
  const double most = static_cast<double>(max_functions);
  const auto used = [&](const Start& start) {
    return expected_functions(*start.mesh, options.degree) / most;
  };
  std::unique_ptr<Start> start = start_with(grid, options, max_functions, log);
  if (options.feature_share < kShareWithRoom) {
    if (log.report.chains_over_budget == 0 || used(*start) > kUsed) return start;
    return start_with_share(kShareWithRoom, grid, options, max_functions, log);
  }
  if (!start->mapped.over_share || !features::is_drawing(grid.original)) return start;
  Report report = log.report;
  const Progress progress = log.progress;
  std::unique_ptr<Start> whole = start_with_share(kNoLimit, grid, options, max_functions, log);
  if (!whole->mapped.over_share && used(*whole) <= kUsedByAll) return whole;
  report.rounds = log.report.rounds;  // with the time that this took
  log.report = std::move(report);
  log.progress = progress;
  return start;
}

}  // namespace knotreel::vectorize
