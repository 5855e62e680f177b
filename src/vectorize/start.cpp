#include "vectorize/start.h"

#include "knotreel/base/parallel.h"
#include "vectorize/feature_budget.h"
#include "vectorize/first_knots.h"

namespace knotreel::vectorize {
namespace {

constexpr double kUsed = 0.4;           // of the control points, at most, if there is room
constexpr double kShareWithRoom = 0.6;  // for features then

std::unique_ptr<Start> start_with(const image::Image& picture, const Options& options,
                                  std::size_t max_functions, RunLog& log) {
  auto start = std::make_unique<Start>();
  map_features(picture, options, max_functions, log, start->mapped);
  start->target.emplace(make_target(picture, start->mapped));
  log.lap("resample");
  start->mesh.emplace(start->mapped.knots);
  // Knots go in one after the other, which takes one thread.
  parallel_invoke([&] { insert_first_knots(*start->target, max_functions, options, *start->mesh); },
                  [&] { start->samples.emplace(picture, start->mapped, options.half_rows); });
  log.lap("place");
  return start;
}

}  // namespace

std::unique_ptr<Start> make_start(const image::Image& picture, const Options& options,
                                  std::size_t max_functions, RunLog& log) {
  std::unique_ptr<Start> start = start_with(picture, options, max_functions, log);
  const double used = expected_functions(*start->mesh, options.degree);
  const bool has_room = used <= kUsed * static_cast<double>(max_functions);
  if (log.report.chains_over_budget == 0 || !has_room || options.feature_share >= kShareWithRoom)
    return start;
  Options more = options;
  more.feature_share = kShareWithRoom;
  log.report.chains = log.report.feature_pixels = log.report.chains_over_budget = 0;
  return start_with(picture, more, max_functions, log);
}

}  // namespace knotreel::vectorize
