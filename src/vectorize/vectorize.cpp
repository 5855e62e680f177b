// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/vectorize/vectorize.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/image/enlarge.h"
#include "knotreel/image/hidden_colours.h"
#include "vectorize/check_options.h"
#include "vectorize/check_picture.h"
#include "vectorize/draft.h"
#include "vectorize/fine_grid.h"
#include "vectorize/finish.h"
#include "vectorize/judge.h"
#include "vectorize/rounds.h"
#include "vectorize/run_log.h"
#include "vectorize/samples.h"
#include "vectorize/start.h"

namespace knotreel::vectorize {

namespace {

// Stills of drawings below this are hard to read; dB.
constexpr double kLegible = 32;
// Of the pixels of a drawing that can be made legible, flat ones at least. What is dithered has fewer, and is
// lost with any bound.
constexpr double kLeastFlat = 0.5;

Bounds bounds_of(const Options& options, const image::Image& picture) {
  const std::size_t usual = most_control_points(options, picture);
  const bool may_grow = options.max_control_points == 0 && options.room_for_features;
  return {usual, may_grow ? default_control_points_with_features(picture) : usual};
}

/// Moves all knots against the true error.
void descend(const Options& options, const Samples& samples, RunLog& log, Draft& draft) {
  if (draft.fits_all_pixels && samples.steers_by_half_rows()) {
    fit::ColourFitOptions from_last = options.colour;
    from_last.start = draft.surface.fit.control;
    draft.surface.fit = fit::fit_colours(draft.steering->values, samples.steering(), from_last);
    draft.fits_all_pixels = false;
  }
  fit::DescentOptions descent;
  descent.steps = options.descent_steps;
  descent.min_distance = options.optimise.min_distance;
  descent.along_curves = options.descend_along_curves;
  descent.colour = options.colour;
  descent.on_step = [&] { log.step("descent step"); };
  draft.surface =
      fit::descend(std::move(draft.surface), samples.steering(), descent, std::move(draft.steering));
  log.lap("descend");
}

/// One picture on its way through the stages.
class Run {
 public:
  Run(const image::Image& picture, const Options& options, const Observer& observer)
      : picture_(picture), options_(suited_to(picture, options)), log_(picture, observer) {}

  Vectorization run() {
    log_.begin_round("round 1");
    if (!wants_fine_grid(picture_, options_)) return run({picture_, picture_}, options_);
    const image::Image enlarged = image::enlarge_twofold(picture_);
    log_.progress.picture = &enlarged;
    log_.report.fine_grid = true;
    log_.lap("enlarge");
    return run({enlarged, picture_}, on_fine_grid(options_));
  }

 private:
  /// @param options in pixels of the grid.
  Vectorization run(const Grid& grid, const Options& options) {
    std::unique_ptr<Start> start = make_start(grid, options, bounds_of(options_, picture_), log_);
    log_.report.max_control_points = start->max_functions;
    std::optional<Halved> half;
    if (grid.scale() > 1) half.emplace(start->mapped, picture_);
    start->mapped.forget_pixels();
    log_.progress.image_mesh = nullptr;
    log_.progress.parametrization = nullptr;
    improve(*start, half ? &half->samples() : nullptr, options);
    draft_.steering.reset();
    log_.begin_round("final");
    if (!half) return finished(*start->samples);
    draft_ = halved(draft_);
    log_.progress = {};
    log_.progress.picture = &picture_;
    start.reset();
    return finished(half->samples());
  }

  /// @param of_picture samples of the picture itself, if the others are of a fine grid; or null.
  void improve(Start& start, Samples* of_picture, const Options& options) {
    refine(start, of_picture, options);
    start.target.reset();  // 24 bytes per pixel, or more
    if (options.descent_steps == 0) return;
    log_.begin_round("descent");
    descend(options, *start.samples, log_, draft_);
    end_round(*start.samples);
  }

  void refine(Start& start, Samples* of_picture, const Options& options) {
    Samples& samples = *start.samples;
    Rounds rounds(options, *start.target, samples, start.max_functions, log_, draft_);
    rounds.first(std::move(*start.mesh), start.mapped.knots);
    end_round(samples);
    Judge judge(options_, samples, of_picture, log_, draft_);
    for (int round = 2; round <= options.rounds; ++round) {
      const Missed left = judge.missed();
      if (!left.means && left.blocks.empty()) break;
      log_.begin_round("round " + std::to_string(round));
      if (!rounds.next(round, left.blocks)) {
        log_.report.rounds.pop_back();
        break;
      }
      end_round(samples);
    }
  }

  Vectorization finished(Samples& samples) {
    Fitted fitted = finish(options_, samples, log_, draft_);
    end_round(samples);
    return {std::move(model_), std::move(log_.report), std::move(fitted)};
  }

  void end_round(const Samples& samples) {
    RoundReport& report = log_.round();
    report.knots = draft_.surface.space->mesh().knots.size();
    report.control_points = draft_.surface.space->function_count();
    report.meg = draft_.meg * picture_.width / samples.picture().width;
    measure_colours(samples, draft_, report);
    model_ = draft_.model(picture_.channels);
    report.raw_bytes = document::raw_accounting_bytes(model_);
    log_.progress.model = &model_;
    log_.progress.residual = &draft_.surface.fit.residual;
    log_.show(report.name);
  }

  const image::Image& picture_;
  const Options options_;
  RunLog log_;
  Draft draft_;
  document::FrameModel model_;
};

/// Where features meet at next to no angle, faces can come out too flat to be stored (seen in one of some
/// hundred frames of charts, before their polylines kept apart): the picture is made without any then.
Vectorization run_or_drop_features(const image::Image& picture, const Options& options,
                                   const Observer& observer) {
  try {
    return Run(picture, options, observer).run();
  } catch (const document::FlatFace&) {
    if (!options.features) throw;
  }
  Options without = options;
  without.features = false;
  Vectorization made = Run(picture, without, observer).run();
  made.report.features_dropped = true;
  return made;
}

/// Whether a drawing has too few control points, and may have more: marks of some pixels, such as dots, are
/// not known as features, and so do not count in its bound.
bool wants_more_control_points(const Vectorization& made, const image::Image& picture,
                               const Options& options) {
  return made.report.rounds.back().psnr < kLegible && features::is_drawing(picture) &&
         features::flat_share(picture) >= kLeastFlat &&
         bounds_of(options, picture).with_features > made.report.max_control_points;
}

Vectorization run_with_enough(const image::Image& picture, const Options& options, const Observer& observer) {
  Vectorization made = run_or_drop_features(picture, options, observer);
  if (!wants_more_control_points(made, picture, options)) return made;
  Options more = options;
  more.max_control_points = bounds_of(options, picture).with_features;
  return run_or_drop_features(picture, more, observer);
}

}  // namespace

Vectorization vectorize_picture(const image::Image& picture, const Options& options,
                                const Observer& observer) {
  check_picture(picture);
  check_options(options);
  if (!picture.has_alpha()) return run_with_enough(picture, options, observer);
  return run_with_enough(image::extend_seen_colours(picture), options, observer);
}

}  // namespace knotreel::vectorize
