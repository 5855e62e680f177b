#include "track/cold_frame.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/raster/render.h"
#include "track/quality.h"
#include "vectorize/feature_budget.h"

namespace knotreel::track {
namespace {

// By which a drawing must be better with the options of drawings, since its frames take longer then; dB.
constexpr double kGainOfDrawing = 0.5;
// Share of the control points that it may use up: features change from frame to frame, and need room for
// that.
constexpr double kMostOfBound = 0.95;
constexpr double kMostAtFirst = 0.75;  // by the first knots, which may have 0.8
// Softness of edges (document::FrameModel) up to which a drawing that has room is better for certain.
constexpr double kCrisp = 0.02;

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// PSNR as drawn, for as many control points: half of them is worth about 3 dB.
double worth(const ColdFrame& cold, const image::Image& picture) {
  std::vector<float> residual = raster::render(model_of(cold.frame, picture.channels));
  std::transform(picture.samples.begin(), picture.samples.end(), residual.begin(), residual.begin(),
                 std::minus());
  return quality_of(residual, {}, picture).psnr -
         10 * std::log10(static_cast<double>(cold.frame.space->function_count()));
}

}  // namespace

std::shared_ptr<ColdFrame> cold_frame_with(const vectorize::Options& options, bool is_drawn,
                                           const image::Image& picture, double colour_step,
                                           const vectorize::Observer& observer) {
  const Clock::time_point start = Clock::now();
  vectorize::Vectorization made = vectorize::vectorize_picture(picture, options, observer);
  const auto cold = std::make_shared<ColdFrame>();
  FittedFrame& frame = cold->frame;
  if (is_drawn) {
    frame.drawn = {made.report.feature_share, made.report.chains_over_budget > 0,
                   made.report.strong_over_budget};
  }
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

namespace {

bool has_crisp_edges(const FittedFrame& frame) {
  return !frame.space->mesh().segments.empty() && frame.edge_softness <= kCrisp;
}

/// Thrown by observers of frames that are not wanted any more.
struct CalledOff {};

/// Of a drawing, which is made in both ways at once.
class TwoWays {
 public:
  TwoWays(const image::Image& picture, const vectorize::Options& film, const vectorize::Options& drawn,
          double colour_step)
      : picture_(picture), film_options_(film), drawn_options_(drawn), colour_step_(colour_step) {
    parallel_invoke([&] { make_drawing(); }, [&] { make_film(); });
    if (drawing_ && has_crisp_edges(drawing_->frame)) return;
    if (!film_) film_ = cold_frame_with(film_options_, false, picture_, colour_step_, {});
    if (drawing_ && worth(*drawing_, picture_) < worth(*film_, picture_) + kGainOfDrawing) drawing_.reset();
  }

  bool is_drawn() const { return drawing_ != nullptr; }
  std::shared_ptr<ColdFrame> better() { return drawing_ ? drawing_ : film_; }

 private:
  /// Nothing if it uses up too many control points, of which the first knots tell mostly.
  void make_drawing() {
    const auto most = static_cast<double>(vectorize::most_control_points(drawn_options_, picture_));
    const auto look = [&](const vectorize::Progress& progress) {
      if (progress.stage != "knots") return;
      const double functions =
          vectorize::expected_functions(mesh::EditableMesh(*progress.knot_mesh), drawn_options_.degree);
      if (functions > kMostAtFirst * most) throw CalledOff();
      has_room_ = true;
    };
    try {
      drawing_ = cold_frame_with(drawn_options_, true, picture_, colour_step_, look);
      if (static_cast<double>(drawing_->frame.space->function_count()) > kMostOfBound * most)
        drawing_.reset();
    } catch (const CalledOff&) {
    }
  }

  /// Left off as soon as the drawing has room, since most that have are better: then it is in the way.
  void make_film() {
    const auto look = [&](const vectorize::Progress&) {
      if (has_room_) throw CalledOff();
    };
    try {
      film_ = cold_frame_with(film_options_, false, picture_, colour_step_, look);
    } catch (const CalledOff&) {
    }
  }

  const image::Image& picture_;
  const vectorize::Options& film_options_;
  const vectorize::Options& drawn_options_;
  double colour_step_;
  std::atomic<bool> has_room_ = false;  ///< the drawing, by its first knots
  std::shared_ptr<ColdFrame> drawing_;
  std::shared_ptr<ColdFrame> film_;
};

}  // namespace

std::shared_ptr<ColdFrame> make_cold_frame(const image::Image& picture, const vectorize::Options& options,
                                           const vectorize::Options* drawn, double colour_step,
                                           const vectorize::Observer& observer) {
  if (!drawn || !features::is_drawing(picture))
    return cold_frame_with(options, false, picture, colour_step, observer);
  const Clock::time_point start = Clock::now();
  TwoWays ways(picture, options, *drawn, colour_step);
  // What is watched is what is kept, at the price of doing it twice.
  if (observer) {
    return cold_frame_with(ways.is_drawn() ? *drawn : options, ways.is_drawn(), picture, colour_step,
                           observer);
  }
  std::shared_ptr<ColdFrame> better = ways.better();
  better->milliseconds = {{"cold", milliseconds_since(start)}};
  return better;
}

}  // namespace knotreel::track
