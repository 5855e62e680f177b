// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/cold_frame.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/features/scale.h"
#include "track/quality.h"
#include "vectorize/feature_budget.h"
#include "vectorize/fine_grid.h"

namespace knotreel::track {
namespace {

// By which a drawing must be better with the options of drawings, or densely, since its frames take longer
// then; dB.
constexpr double kGainOfDrawing = 0.5;
constexpr double kGainOfCramped = 3;  // without room for the frames behind: they will often be made anew
constexpr double kGainOfDense = 2;    // over illegible film
// Shares of the control points that features ask for: with fewer, it is not for their sake that there is no
// room; with more, the frames behind have none.
constexpr double kManyFeatures = 0.45;
constexpr double kTooManyFeatures = 0.8;
constexpr double kClear = 42;  // dB; film of a drawing that is worse may be better as one in spite of all
// Share of the control points that it may use up: features change from frame to frame, and need room for
// that.
constexpr double kMostOfBound = 0.95;
constexpr double kMostAtFirst = 0.75;  // by the first knots, which may have 0.8
// Share of the pixels: who allows so many control points wants drawings whose features fill them, too.
constexpr double kGenerous = 0.05;
// Control points over those of film: with fewer than that, densely is no better where there are no features.
constexpr double kManyMore = 2;
// Softness of edges (document::FrameModel) up to which a drawing that has room is better for certain.
constexpr double kCrisp = 0.02;

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// For as many control points: half of them is worth about 3 dB. @param psnr as drawn.
double worth(const ColdFrame& cold, double psnr) {
  return psnr - 10 * std::log10(static_cast<double>(cold.frame.space->function_count()));
}

double worth(const ColdFrame& cold, const image::Image& picture) {
  return worth(cold, psnr_as_drawn(cold.frame, picture));
}

enum class Way : std::uint8_t {
  kFilm,
  kDrawn,
  kPlain,  ///< drawn, on the plain grid
  kDense,
  kCramped,  ///< even denser, without room for the frames behind
  kDenseFilm,
};

bool is_film(Way way) {
  return way == Way::kFilm || way == Way::kDenseFilm;
}

bool is_dense(Way way) {
  return way == Way::kDense || way == Way::kCramped || way == Way::kDenseFilm;
}

vectorize::Options options_for(Way way, const ColdOptions& options) {
  if (way == Way::kFilm) return options.film;
  if (way == Way::kDense) return *options.dense;
  if (way == Way::kCramped) return *options.cramped;
  if (way == Way::kDenseFilm) return *options.dense_film;
  vectorize::Options drawn = *options.drawn;
  if (way == Way::kPlain) drawn.fine_grid = vectorize::FineGrid::kNone;
  return drawn;
}

std::shared_ptr<ColdFrame> made_in(Way way, const ColdOptions& options, const image::Image& picture,
                                   double colour_step, const vectorize::Observer& observer = {}) {
  const Clock::time_point start = Clock::now();
  vectorize::Vectorization made = vectorize::vectorize_picture(picture, options_for(way, options), observer);
  const auto cold = std::make_shared<ColdFrame>();
  cold->features_dropped = made.report.features_dropped;
  FittedFrame& frame = cold->frame;
  if (!is_film(way)) {
    frame.drawn = {made.report.feature_share, made.report.chains_over_budget > 0,
                   made.report.strong_over_budget, made.report.fine_grid};
  }
  frame.dense = is_dense(way);
  frame.cramped = way == Way::kCramped;
  frame.space = made.model.space;
  frame.displacement = std::move(made.model.displacement);
  frame.edge_softness = made.model.edge_softness;
  frame.colour_step = colour_step;
  frame.colours.control = std::move(made.model.colour);
  document::round_colours(frame.colours.control, colour_step);
  cold->milliseconds.emplace_back("cold", milliseconds_since(start));
  const Clock::time_point fitted = Clock::now();
  frame.basis = std::move(made.fitted.basis);
  frame.seen = placed_pixels(picture,
                             std::make_shared<const spline::PlacedBasis>(
                                 frame.basis, picture.width, picture.height, std::move(made.fitted.places)),
                             made.fitted.crossed, 0);  // it was not fitted to a sharpened picture
  frame.surface = surface_at(frame.seen, frame.colours.control);
  frame.colours.residual = residual_of(frame.seen, *frame.surface);
  cold->milliseconds.emplace_back("measure", milliseconds_since(fitted));
  return cold;
}

bool has_crisp_edges(const FittedFrame& frame) {
  return !frame.space->mesh().segments.empty() && frame.edge_softness <= kCrisp;
}

double most_functions(const vectorize::Options& options, const image::Image& picture) {
  return static_cast<double>(vectorize::most_control_points(options, picture));
}

bool has_room(const ColdFrame& cold, const vectorize::Options& options, const image::Image& picture) {
  return static_cast<double>(cold.frame.space->function_count()) <=
         kMostOfBound * most_functions(options, picture);
}

bool is_poor(const ColdFrame& cold, const vectorize::Options& options, const image::Image& picture) {
  return quality_of(cold.frame.colours.residual, cold.frame.seen.weights, picture).mec > options.mec;
}

/// Whether a drawing may fill its control points, without room for the frames behind.
bool may_be_cramped(Way way, const vectorize::Options& options, const image::Image& picture) {
  return way != Way::kDense &&
         most_functions(options, picture) >= kGenerous * static_cast<double>(picture.pixel_count());
}

double expected_functions(const vectorize::Progress& progress, int degree) {
  return vectorize::expected_functions(mesh::EditableMesh(*progress.knot_mesh), degree);
}

/// Thrown by observers of frames that are not wanted any more.
struct CalledOff {};

/// Whether the first knots, on the plain grid, tell that there is room: on a fine one that takes much longer.
/// @param features becomes the share of the control points that features ask for, if that is looked at.
bool may_have_room(const ColdOptions& options, const image::Image& picture, double& features) {
  struct Told {
    bool has_room;
  };
  const vectorize::Options plain = options_for(Way::kPlain, options);
  if (may_be_cramped(Way::kDrawn, plain, picture)) return true;
  const double most = most_functions(plain, picture);
  try {
    vectorize::vectorize_picture(picture, plain, [&](const vectorize::Progress& progress) {
      if (progress.stage == "features") features = vectorize::expected_functions(*progress.detected) / most;
      if (progress.stage == "knots")
        throw Told{expected_functions(progress, plain.degree) <= kMostAtFirst * most};
    });
  } catch (const Told& told) {
    return told.has_room;
  }
  return true;
}

/// Nothing if it uses up too many control points, of which features and the first knots tell mostly.
/// @param may_be_full unless its features alone are too many, if it is dense.
/// @param on_room called once it is told that there is room. May be empty.
/// @param on_bare called if there are no features, of which nothing is made then. May be empty.
std::shared_ptr<ColdFrame> drawing_with_room(Way way, const ColdOptions& options, const image::Image& picture,
                                             double colour_step, bool may_be_full,
                                             const std::function<void()>& on_room,
                                             const std::function<void()>& on_bare = {}) {
  const vectorize::Options chosen = options_for(way, options);
  const double most = most_functions(chosen, picture);
  int fairings = 0;
  const auto look = [&](const vectorize::Progress& progress) {
    if (progress.stage == "features" && on_bare && progress.detected->chains.empty()) {
      on_bare();
      throw CalledOff();
    }
    if (progress.stage == "features" && !may_be_full) {
      fairings = 0;
      const int scale = features::scale_of(*progress.detected, picture);
      if (vectorize::expected_functions(*progress.detected) > scale * most) throw CalledOff();
    }
    // Once more: some had to go. What is dense is so for its features.
    if (progress.stage == "fairing" && ++fairings > 1 && is_dense(way)) throw CalledOff();
    if (progress.stage != "knots") return;
    const bool is_full = expected_functions(progress, chosen.degree) > kMostAtFirst * most;
    if (is_full && !may_be_full) throw CalledOff();
    if (!is_full && on_room) on_room();
  };
  try {
    std::shared_ptr<ColdFrame> made = made_in(way, options, picture, colour_step, look);
    return may_be_full || has_room(*made, chosen, picture) ? made : nullptr;
  } catch (const CalledOff&) {
    return nullptr;
  }
}

/// Of a drawing, which is made in all ways that may be worth it.
class Ways {
 public:
  Ways(const image::Image& picture, const ColdOptions& options, double colour_step)
      : picture_(picture), options_(options), colour_step_(colour_step) {
    parallel_invoke([&] { make_drawing(); }, [&] { make_film(); });
    const bool is_cramped = drawing_ && !drawing_has_room();
    if (drawing_ && !is_cramped && best_ != Way::kDense && has_crisp_edges(drawing_->frame)) return;
    if (!film_) film_ = made_in(Way::kFilm, options_, picture_, colour_step_);
    const double film = psnr_as_drawn(film_->frame, picture_);
    if (drawing_ && drawing_is_better(film, is_cramped ? kGainOfCramped : kGainOfDrawing)) return;
    const bool is_known = drawing_ && !is_dense(best_);
    best_ = Way::kFilm;
    if (film < kLegible) {
      if (options_.dense_film && make_dense_film(film) >= kLegible) return;
      if (options_.cramped) make_cramped(film);
    }
    if (best_ == Way::kFilm && !is_known && film < kClear && features_ > kManyFeatures &&
        features_ < kTooManyFeatures)
      make_with_fewer_features(film);
  }

  Way best() const { return best_; }
  std::shared_ptr<ColdFrame> made() const { return is_film(best_) ? film_ : drawing_; }

 private:
  /// What has no room on the fine grid may have it on the plain one; else it is tried densely.
  void make_drawing() {
    const bool is_fine = vectorize::wants_fine_grid(picture_, *options_.drawn);
    if (!is_fine || may_have_room(options_, picture_, features_)) {
      film_is_in_the_way_ = is_fine;
      if (is_fine) take(Way::kDrawn);
      if (!drawing_ || !drawing_has_room()) take(Way::kPlain);
    }
    if (options_.dense && !is_bare_ && (!drawing_ || !drawing_has_room())) take(Way::kDense);
  }

  /// If there is room, or nothing else so far.
  void take(Way way) {
    std::function<void()> prefer;
    if (way != Way::kDense) prefer = [this] { film_is_in_the_way_ = true; };
    std::function<void()> leave;
    if (way == Way::kPlain && !may_have_many_more()) leave = [this] { is_bare_ = true; };
    // One that has room is not replaced by one without.
    const bool may_be_full = !drawing_ && may_be_cramped(way, options_for(way, options_), picture_);
    std::shared_ptr<ColdFrame> made =
        drawing_with_room(way, options_, picture_, colour_step_, may_be_full, prefer, leave);
    if (!made) return;
    drawing_ = std::move(made);
    best_ = way;
  }

  /// @param film PSNR of the film. @param gain for as many control points, unless that is illegible.
  bool drawing_is_better(double film, double gain) const {
    const double drawn = psnr_as_drawn(drawing_->frame, picture_);
    if (best_ == Way::kDense && film < kLegible && drawn >= film + kGainOfDense) return true;
    return worth(*drawing_, drawn) >= worth(*film_, film) + gain;
  }

  /// Large pictures have no more, since all bounds end at the same number.
  bool may_have_many_more() const {
    return !options_.dense ||
           most_functions(*options_.dense, picture_) >= kManyMore * most_functions(options_.film, picture_);
  }

  bool drawing_has_room() const { return has_room(*drawing_, options_for(best_, options_), picture_); }

  /// Left off as soon as the drawing has room, since most that have are better.
  void make_film() {
    const auto look = [&](const vectorize::Progress&) {
      if (film_is_in_the_way_) throw CalledOff();
    };
    try {
      film_ = made_in(Way::kFilm, options_, picture_, colour_step_, look);
    } catch (const CalledOff&) {
    }
  }

  /// On the fine grid, for which there was no room. Kept if it is so much better that the frames behind it
  /// may be made anew more often. @param film PSNR of the film.
  void make_with_fewer_features(double film) {
    std::shared_ptr<ColdFrame> made = made_in(Way::kDrawn, options_, picture_, colour_step_);
    const double most = most_functions(*options_.drawn, picture_);
    if (static_cast<double>(made->frame.space->function_count()) > most) return;  // strong features stay
    if (worth(*made, picture_) < worth(*film_, film) + kGainOfCramped) return;
    drawing_ = std::move(made);
    best_ = Way::kDrawn;
  }

  /// Kept if that is legible. @param film PSNR of the film, which is not.
  void make_cramped(double film) {
    std::shared_ptr<ColdFrame> made =
        drawing_with_room(Way::kCramped, options_, picture_, colour_step_, true, {});
    if (!made || psnr_as_drawn(made->frame, picture_) < std::max(kLegible, film + kGainOfCramped)) return;
    drawing_ = std::move(made);
    best_ = Way::kCramped;
  }

  /// Kept if that is better. @param film PSNR of the other. @return PSNR of what is kept.
  double make_dense_film(double film) {
    std::shared_ptr<ColdFrame> dense = made_in(Way::kDenseFilm, options_, picture_, colour_step_);
    const double psnr = psnr_as_drawn(dense->frame, picture_);
    if (psnr < film + kGainOfDense) return film;
    film_ = std::move(dense);
    best_ = Way::kDenseFilm;
    return psnr;
  }

  const image::Image& picture_;
  const ColdOptions& options_;
  double colour_step_;
  std::atomic<bool> film_is_in_the_way_ = false;
  /// Share of the control points of a drawing that its features ask for, if it is for the fine grid.
  double features_ = 0;
  bool is_bare_ = false;  ///< without features, and so no better than film, which is made in the meantime
  Way best_ = Way::kDrawn;
  std::shared_ptr<ColdFrame> drawing_;
  std::shared_ptr<ColdFrame> film_;
};

}  // namespace

std::size_t most_for_film(const image::Image& picture, const vectorize::Options& film,
                          const vectorize::Options* dense_film) {
  const std::size_t usual = vectorize::most_control_points(film, picture);
  if (!dense_film) return usual;
  return vectorize::with_captions(picture, usual, vectorize::most_control_points(*dense_film, picture));
}

std::shared_ptr<ColdFrame> make_cold_frame(const image::Image& picture, const ColdOptions& options,
                                           double colour_step, const vectorize::Observer& observer) {
  if (!options.drawn || !features::is_drawing(picture)) {
    vectorize::Options film = options.film;
    if (options.dense_film) film.max_control_points = most_for_film(picture, film, options.dense_film);
    return made_in(Way::kFilm, {film}, picture, colour_step, observer);
  }
  const Clock::time_point start = Clock::now();
  const Ways ways(picture, options, colour_step);
  // What is watched is what is kept, at the price of doing it twice.
  if (observer) return made_in(ways.best(), options, picture, colour_step, observer);
  std::shared_ptr<ColdFrame> best = ways.made();
  best->milliseconds = {{"cold", milliseconds_since(start)}};
  return best;
}

std::shared_ptr<ColdFrame> make_drawn_frame(const image::Image& picture, const ColdOptions& options,
                                            const FittedFrame& group, double colour_step) {
  const Way way = group.cramped            ? Way::kCramped
                  : group.dense            ? Way::kDense
                  : group.drawn->fine_grid ? Way::kDrawn
                                           : Way::kPlain;
  std::shared_ptr<ColdFrame> made = made_in(way, options, picture, colour_step);
  if (is_dense(way) || has_room(*made, *options.drawn, picture)) return made;
  const auto take_if_better = [&](const std::shared_ptr<ColdFrame>& other) {
    if (other && worth(*other, picture) >= worth(*made, picture) + kGainOfDrawing) made = other;
  };
  if (way == Way::kDrawn && is_poor(*made, *options.drawn, picture))
    take_if_better(made_in(Way::kPlain, options, picture, colour_step));
  if (options.dense) take_if_better(drawing_with_room(Way::kDense, options, picture, colour_step, false, {}));
  return made;
}

}  // namespace knotreel::track
