// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/tracker.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <unordered_set>
#include <utility>

#include "base/tiles_around.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/knots/block_errors.h"
#include "knotreel/knots/idle_knots.h"
#include "knotreel/raster/edge_softness.h"
#include "knotreel/spline/fingerprint.h"
#include "knotreel/track/group_rule.h"
#include "track/carried_geometry.h"
#include "track/carried_links.h"
#include "track/carried_mesh.h"
#include "track/cold_frame.h"
#include "track/cold_outlook.h"
#include "track/colour_coarseness.h"
#include "track/curve_bending.h"
#include "track/drawn_features.h"
#include "track/fit_watch.h"
#include "track/fitted_frame.h"
#include "track/foresee.h"
#include "track/knot_motion.h"
#include "track/laps.h"
#include "track/matching.h"
#include "track/new_knots.h"
#include "track/quality.h"
#include "track/redraw_mesh.h"
#include "track/rework.h"
#include "track/warm_fit.h"
#include "vectorize/check_picture.h"

namespace knotreel::track {

const char* to_string(Start start) {
  switch (start) {
    case Start::kFirst:
      return "first";
    case Start::kCut:
      return "cut";
    case Start::kInterval:
      return "interval";
    case Start::kDrift:
      return "drift";
    default:
      return "warm";
  }
}

namespace {

constexpr int kFramesToRest = 4;
constexpr double kRestToUse = 0.1;   // share of a picture; with less, to look for what is the same costs more
constexpr double kLeftOut = 2;       // times vectorize::Options::block_error: where that is seen at once
constexpr double kFull = 0.95;       // share of the control points
constexpr double kGainOfHeld = 0.5;  // dB, by a cold frame: what is held is looked at for long
constexpr int kSoftnessInterval = 16;     // frames; the cold one's is of curves that lie better
constexpr std::size_t kTilesOfEdges = 1;  // the colours around a pixel have a part in it where there are some
constexpr std::size_t kBoundMargin = 2;   // knots that go at once above the bound: a space anew is dearer
// Times CarryOptions::min_distance: between outlines, knots are close to them from the first frame on.
constexpr double kDrawnDistance = 0.5;

using mesh::EditableMesh;
using mesh::KnotIndex;
using mesh::KnotMesh;

double share_alive(const KnotMesh& before, const KnotMesh& now) {
  std::unordered_set<std::uint32_t> ids;
  for (const mesh::Knot& k : now.knots) ids.insert(static_cast<std::uint32_t>(k.id));
  std::size_t alive = 0;
  for (const mesh::Knot& k : before.knots) alive += ids.count(static_cast<std::uint32_t>(k.id));
  return static_cast<double>(alive) / static_cast<double>(before.knots.size());
}

/// Takes what came of a frame from it, and leaves what the next one is made from.
FittedFrame handed_over(FittedFrame& frame) {
  FittedFrame next;
  next.space = frame.space;
  next.displacement = frame.displacement;
  next.edge_softness = frame.edge_softness;
  next.drawn = frame.drawn;
  next.dense = frame.dense;
  next.cramped = frame.cramped;
  FittedFrame before = std::exchange(frame, std::move(next));
  before.basis.reset();
  if (before.prints.empty()) {  // nobody will look for what is the same
    before.surface.reset();
    before.seen.placed.reset();
    before.seen.picture = {};
  }
  return before;
}

}  // namespace

class Tracker::Impl {
 public:
  Impl(const vectorize::Options& cold, const TrackOptions& options, Start first)
      : cold_(cold),
        options_(options),
        groups_(options, first),
        outlook_(cold),
        watch_(options),
        rework_(cold, options),
        bending_(options, cold.unfold) {}

  document::FrameModel next(const image::Image& picture, const Motion* motion, FrameReport& report,
                            MadeAhead ahead) {
    report_ = &report;
    std::shared_ptr<ColdFrame> cold = std::move(ahead.cold);
    report = {};
    laps_.emplace(report.milliseconds);
    report.start = groups_.next(motion);
    count_most_functions(picture);
    if (report.start == Start::kWarm) {
      cold.reset();
      if (motion->repeated) {
        repeat();
      } else if (!make_warm_if_sound(picture, *motion, std::move(ahead.curves))) {
        cold = cold_frame(picture);
      }
      // While the first picture of a group is repeated, there is no target, and a cold frame is what there
      // is.
      if (!cold && target_ && misses_thresholds()) {
        const bool is_time_to_look = watch_.is_time_to_look(report.psnr);
        if (is_time_to_look || watch_.is_held()) cold = better_cold_frame(picture);
      }
      if (cold) {
        report.start = Start::kDrift;
        report.survival = 0;  // what was done before was in vain
        report.changes = {};
        groups_.restart();
      } else if (!motion->repeated) {
        const bool needs_mending = watch_.needs_mending(report.psnr, report.changes.repairs > 0);
        watch_.end_frame(report.psnr, report.changes.repairs > 0);
        coarseness_.end_frame(report.psnr);
        keep_for_next(picture, needs_mending);
      }
    }
    if (report.start != Start::kWarm) {
      if (report.start != Start::kDrift) target_.reset();  // it is that of the frame before
      take_over(cold ? std::move(*cold)
                     : std::move(*make_cold_frame(picture, cold_options(), options_.colour_step)));
      start_group(picture);
    }
    report.knots = frame_.space->mesh().knots.size();
    report.control_points = frame_.space->function_count();
    drawing_ = drawing_of_frame();
    if (drawing_ == Drawing::kNone) known_drawings_->keep(nullptr);
    return model(picture, report.start != Start::kWarm);
  }

  bool starts_group(const Motion* motion) const { return groups_.start_of(motion) != Start::kWarm; }
  std::shared_ptr<const spline::PixelSurface> surface() const { return frame_.surface; }
  Drawing drawing() const { return drawing_; }

  std::vector<std::uint8_t> changed_tiles() const {
    if (frame_.same.empty() || frame_.edge_softness != frame_before_.edge_softness) return {};
    std::vector<std::uint8_t> changed;
    for (const std::uint8_t same : frame_.same) changed.push_back(same ? 0 : 1);
    return tiles_around(changed, frame_.values().tile_columns(), kTilesOfEdges);
  }

  const std::shared_ptr<KnownDrawings>& known_drawings() const { return known_drawings_; }

 private:
  ColdOptions cold_options() const {
    return {cold_, options_.drawn.get(), options_.dense.get(), options_.dense_film.get(),
            options_.cramped.get()};
  }

  /// Those of the group.
  const vectorize::Options& group_options() const {
    if (frame_.cramped) return *options_.cramped;
    if (frame_.drawn) return frame_.dense ? *options_.dense : *options_.drawn;
    return frame_.dense ? *options_.dense_film : cold_;
  }

  Drawing drawing_of_frame() const {
    if (!frame_.drawn) return Drawing::kNone;
    return frame_.drawn->fine_grid ? Drawing::kFineGrid : Drawing::kPlain;
  }

  // -- cold frames

  void take_over(ColdFrame&& cold) {
    frame_ = std::move(cold.frame);
    mesh_ = frame_.space->mesh();
    report_->features_dropped = cold.features_dropped;
    laps_->add(cold.milliseconds);
  }

  /// As the first frame of the group was, so may be those behind it; but captions may come.
  void count_most_functions(const image::Image& picture) {
    most_functions_ = vectorize::most_control_points(group_options(), picture);
    if (frame_.drawn || frame_.dense) return;
    most_functions_ = std::max(most_functions_, captioned_);
    const std::size_t most = most_for_film(picture, cold_, options_.dense_film.get());
    if (most > most_functions_ && !features::is_drawing(picture)) most_functions_ = captioned_ = most;
  }

  void start_group(const image::Image& picture) {
    drawn_.reset();  // of a frame that was thrown away, or of the group before
    is_drawn_ = frame_.drawn.has_value();
    captioned_ = 0;
    count_most_functions(picture);
    measure();
    watch_.start_group(report_->psnr, report_->start, frame_.dense || is_full());
    coarseness_.start_group(report_->psnr);
    rework_.start_group(frame_);
    bending_.start_group();
    since_softness_ = kSoftnessInterval;
    rest_.start(picture.width, picture.height);
    next_id_ = EditableMesh(frame_.space->mesh()).next_id();
    outlook_.start_group(report_->psnr);
    report_->wanted_control_points = wanted_control_points(picture);
    keep_for_next(picture, false);
  }

  std::size_t wanted_control_points(const image::Image& picture) const {
    if (frame_.drawn || !options_.drawn || !features::is_drawing(picture)) return 0;
    const std::size_t wanted = vectorize::default_control_points(picture);
    return wanted > most_functions_ ? wanted : 0;
  }

  void make_target(image::Image picture) {
    target_ = std::make_unique<knots::Target>(std::move(picture), std::vector<float>{});
    outlook_.next_picture();
  }

  void measure() {
    const Quality quality = quality_of(frame_.colours.residual, frame_.seen.weights, frame_.seen.picture);
    report_->mec = quality.mec;
    report_->psnr = quality.psnr;
  }

  /// Whether the frame is above the error that is good enough, or something is left out of it.
  bool misses_thresholds() const {
    if (report_->mec > cold_.mec) return true;
    if (cold_.block_error == 0) return false;
    std::vector<float> errors = squared_errors(frame_);
    const image::Image& picture = frame_.seen.picture;
    const double bound = kLeftOut * cold_.block_error * cold_.mec;
    return knots::keep_worst_blocks(errors, picture.width, picture.height, bound) > 0;
  }

  // -- warm frames

  /// The picture is that of the frame before, and so is the model.
  void repeat() {
    frame_.same.clear();
    report_->survival = 1;
    report_->psnr = watch_.last();
    watch_.end_repeated_frame();
    report_->mec = last_mec_;
  }

  /// make_warm(), but for frames with a face that is too flat to be stored (never seen).
  bool make_warm_if_sound(const image::Image& picture, const Motion& motion,
                          std::shared_ptr<const DrawnCurves> curves) {
    try {
      return make_warm(picture, motion, std::move(curves));
    } catch (const document::FlatFace&) {
      return false;
    }
  }

  /// @param curves of the picture, if they were found ahead.
  /// @return whether there is a mesh to make it from.
  bool make_warm(const image::Image& picture, const Motion& motion,
                 std::shared_ptr<const DrawnCurves> curves) {
    rework_last();
    rest_.add(motion.unchanged);
    is_drawn_ = frame_.drawn && (curves || features::may_be_drawing(picture));
    drawn_.reset();
    std::optional<KnotMesh> carried;
    std::optional<LinkMemory> links;
    std::optional<FaceErrors> errors_before;
    parallel_invoke(
        [&] {
          carried = is_drawn_ ? redrawn_mesh(picture, motion, std::move(curves))
                              : carried_mesh(frame_, next_mesh_, motion, rest_, options_.carry,
                                             report_->changes.carry);
        },
        [&] {
          if (!is_drawn_) errors_before.emplace(mesh_, *target_);
          target_->change_to(picture);
          outlook_.next_picture();
          links.emplace(*frame_.space);
        });
    laps_->lap("carry");
    if (!carried) return false;
    if (errors_before) carried = refilled(*carried, *errors_before);
    laps_->lap("foresee");
    frame_before_ = handed_over(frame_);
    if (drawn_) frame_.drawn = drawn_->limits();
    take_over(*carried, *links);
    // Features alone are too many: a cold frame leaves some out, or has another bound.
    if (drawn_ && frame_.space->function_count() > most_functions_) return false;
    if (drawn_) {
      draw_curves();
    } else {
      bend_curves(*motion.now);
    }
    fit(picture, motion);
    measure();
    if (watch_.has_fallen(report_->psnr)) bending_.fit_has_fallen();
    for (int pass = 0; pass < options_.most_repairs && watch_.needs_repair(report_->psnr); ++pass) {
      if (drawn_ && !misses_thresholds()) break;
      take_over(rework_.at_once(rework_input(), rework_log()), LinkMemory(*frame_.space));
      if (drawn_) draw_curves();
      fit(picture, motion);
      measure();
      ++report_->changes.repairs;
    }
    report_->survival = share_alive(frame_before_.space->mesh(), frame_.space->mesh());
    if (++since_softness_ >= kSoftnessInterval) update_edge_softness(picture);
    return true;
  }

  /// Curves lie less well in warm frames than in the cold one, and pictures get out of focus. Half of the
  /// way, so that edges do not flicker.
  void update_edge_softness(const image::Image& picture) {
    since_softness_ = 0;
    const double fitting =
        raster::fitting_edge_softness(model(picture, false), picture, frame_.basis, frame_.surface);
    frame_.edge_softness = (frame_.edge_softness + fitting) / 2;
    laps_->lap("softness");
  }

  /// The features of a drawing are found anew; the other knots go where the motion takes them. Nothing if
  /// that is no sound mesh, or hardly.
  std::optional<KnotMesh> redrawn_mesh(const image::Image& picture, const Motion& motion,
                                       std::shared_ptr<const DrawnCurves> curves) {
    if (!curves || curves->fine_grid != frame_.drawn->fine_grid)
      curves = find_drawn_curves(picture, *options_.drawn, drawing_of_frame(), known_drawings_);
    const std::vector<Vec2> points = image_positions(frame_, next_mesh_);
    const std::vector<Vec2> moves = knot_motion(next_mesh_, points, motion);
    std::vector<Vec2> vertices;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (next_mesh_.knots[k].kind == mesh::KnotKind::kVertex) vertices.push_back(points[k] + moves[k]);
    }
    drawn_ = std::make_unique<DrawnFeatures>(picture, group_options(), *curves, most_functions_, vertices,
                                             *frame_.drawn);
    next_id_ = std::max(next_id_, EditableMesh(next_mesh_).next_id());
    if (!drawn_->is_sound()) return std::nullopt;
    const CarryOptions options{.min_distance = kDrawnDistance * options_.carry.min_distance};
    return redraw_mesh(drawn_->knots(), next_mesh_, knot_targets(next_mesh_, moves), options, next_id_,
                       report_->changes.carry);
  }

  /// A carried mesh with knots for those that were lost on the way, where the picture asks for them; and for
  /// idle ones, if the frame would be much worse than the one before.
  KnotMesh refilled(const KnotMesh& carried, const FaceErrors& errors_before) {
    EditableMesh mesh(carried, next_id_);
    const Foresight foresight(mesh, *target_, errors_before);
    std::size_t count = next_mesh_.knots.size() - carried.knots.size();
    if (foresight.loss() > options_.swap_above) {
      const std::size_t idle =
          knots::remove_idle_knots(mesh, *target_, foresight.growths(), options_.urgent_swap);
      report_->changes.swapped += idle;
      count += idle;
    }
    const std::vector<KnotIndex> fresh = foresight.insert(mesh, count, options_.carry.min_distance);
    next_id_ = mesh.next_id();
    report_->changes.inserted += fresh.size();
    optimise_new_knots(mesh, fresh, *target_, cold_, options_);
    return mesh.to_mesh();
  }

  /// What was drawn so far is tried no more.
  std::shared_ptr<ColdFrame> cold_frame(const image::Image& picture) const {
    if (frame_.drawn && features::is_drawing(picture))
      return make_drawn_frame(picture, cold_options(), frame_, options_.colour_step);
    return make_cold_frame(picture, cold_options(), options_.colour_step);
  }

  /// Control points that a cold frame may have: illegible film of a drawing may get dense.
  std::size_t most_if_cold(const image::Image& picture) const {
    const bool may_get_dense = options_.dense_film && !frame_.drawn && !frame_.dense &&
                               report_->psnr < kLegible && features::is_drawing(picture);
    return may_get_dense ? vectorize::most_control_points(*options_.dense_film, picture) : most_functions_;
  }

  /// A drawing that lacks control points.
  bool is_full() const {
    if (!frame_.drawn) return false;
    const double most = kFull * static_cast<double>(most_functions_);
    return frame_.drawn->strong_dropped || static_cast<double>(frame_.space->function_count()) >= most;
  }

  /// Whether it may have more. What comes of that nobody can tell without.
  bool may_get_denser() const { return is_full() && !frame_.dense && options_.dense; }

  /// A cold model if that is worth a new group; else the picture has become harder, which is no reason to
  /// look again soon.
  std::shared_ptr<ColdFrame> better_cold_frame(const image::Image& picture) {
    const double gain = watch_.is_held() ? kGainOfHeld : options_.restart_gain;
    watch_.looked(report_->psnr);
    const std::size_t most = most_if_cold(picture);
    const double expected = outlook_.expected_psnr(*target_, most);
    laps_->lap("difficulty");
    if (!may_get_denser() && expected < report_->psnr + gain) return nullptr;
    std::shared_ptr<ColdFrame> cold = cold_frame(picture);
    laps_->add(std::exchange(cold->milliseconds, {}));
    const Quality quality = quality_of(cold->frame.colours.residual, cold->frame.seen.weights, picture);
    const bool is_better = watch_.is_held() || quality.psnr > report_->psnr + gain;
    const bool as_drawn = watch_.is_held() || frame_.drawn;
    if (is_better && (!as_drawn || is_better_as_drawn(cold->frame, picture, gain))) return cold;
    watch_.made_cold_frame_in_vain();
    outlook_.made_in_vain(quality.psnr, *target_, most);
    return nullptr;
  }

  bool is_better_as_drawn(const FittedFrame& cold, const image::Image& picture, double gain) const {
    return psnr_as_drawn(cold, picture) > psnr_as_drawn(frame_, picture) + gain;
  }

  /// The space over a mesh that comes from the one there is, whose links are given. How many functions knots
  /// bring changes with their links: the idlest go until the bound on control points holds.
  void take_over(const KnotMesh& mesh, const LinkMemory& links) {
    const auto over = [&](const KnotMesh& knots) {
      document::StoredMesh stored = document::stored_mesh(knots, options_.knot_bits);
      mesh_ = stored.mesh;
      for (std::size_t k = 0; k < stored.knot_of.size(); ++k)
        mesh_.knots[k].position = knots.knots[stored.knot_of[k]].position;
      return std::make_shared<const spline::SplineSpace>(
          links.space_over(std::move(stored.mesh), cold_.degree, *target_));
    };
    std::shared_ptr<const spline::SplineSpace> space = over(mesh);
    while (space->function_count() > most_functions_) {
      const std::size_t surplus = (space->function_count() - most_functions_) / 2 + kBoundMargin;
      EditableMesh fewer(mesh_, next_id_);
      if (knots::remove_idle_knots(fewer, *target_, {}, {}, surplus) == 0) break;
      space = over(fewer.to_mesh());
    }
    parallel_invoke(
        [&] {
          frame_.displacement = carried_displacement(*frame_.space, frame_.displacement, *space);
          round_displacement();
          match_ = match_functions(*frame_before_.space, *space);
        },
        [&] {
          frame_.basis = std::make_shared<const spline::Basis>(space);
          frame_.basis->index();  // what follows asks for it
          frame_.prints.clear();
          if (rest_.share() >= kRestToUse) frame_.prints = spline::function_fingerprints(*frame_.basis);
        });
    frame_.space = std::move(space);
    laps_->lap("space");
  }

  void round_displacement() { document::round_displacement(frame_.displacement, options_.displacement_step); }

  void bend_curves(const motion::Luma& now) {
    if (bending_.bend(now, rest_, rework_.take_new_features(), frame_)) laps_->lap("geometry");
  }

  /// Puts the curves of a drawing where they were found.
  void draw_curves() {
    frame_.displacement =
        drawn_->displacement(*frame_.basis, options_.drawn->unfold, options_.displacement_step);
    laps_->lap("geometry");
  }

  void fit(const image::Image& picture, const Motion& motion) {
    frame_.colour_step = options_.colour_step * options_.delta_coarseness * coarseness_.factor();
    fit_warm_frame(
        frame_before_,
        {picture, motion, match_, cold_.colour, options_, drawn_ ? options_.drawn->mixed_weight : 0}, frame_,
        *laps_);
  }

  /// What the mesh is reworked by, once there is a next frame: this one need not wait for that.
  void keep_for_next(const image::Image& picture, bool urgent) {
    last_mec_ = report_->mec;
    if (!options_.warm_start) return;
    if (!target_) first_picture_ = picture;
    last_is_urgent_ = urgent;
  }

  /// Makes the mesh to start from of that of the last frame.
  void rework_last() {
    if (!target_) make_target(std::exchange(first_picture_, {}));
    parallel_invoke([&] { outlook_.look_back(*target_, most_functions_); },
                    [&] {
                      next_mesh_ =
                          rework_.for_next_frame(rework_input(), last_mec_, last_is_urgent_, rework_log());
                    });
  }

  ReworkInput rework_input() const {
    return {frame_, mesh_, *target_, rest_, most_functions_, is_drawn_, is_drawn_ && misses_thresholds()};
  }
  ReworkLog rework_log() { return {report_->changes, *laps_, next_id_}; }

  document::FrameModel model(const image::Image& picture, bool keyframe) const {
    document::FrameModel model = model_of(frame_, picture.channels);
    if (keyframe) model.colour_step = document::FrameModel{}.colour_step;
    model.keyframe = keyframe;
    return model;
  }

  vectorize::Options cold_;
  TrackOptions options_;
  GroupRule groups_;
  motion::Rest rest_{kFramesToRest};
  ColdOutlook outlook_;
  FitWatch watch_;
  ColourCoarseness coarseness_;
  FrameReport* report_ = nullptr;
  std::optional<Laps> laps_;  ///< of the report

  FittedFrame frame_;
  /// Of the frame, but with the knots where they are before they are rounded to the grid: motion of less than
  /// a step of it is not lost.
  KnotMesh mesh_;
  KnotMesh next_mesh_;
  std::vector<std::uint32_t> match_;  ///< of the functions of the frame with those of the one before
  FittedFrame frame_before_;
  Rework rework_;
  CurveBending bending_;
  std::atomic<Drawing> drawing_ = Drawing::kNone;  ///< as told to others
  const std::shared_ptr<KnownDrawings> known_drawings_ = std::make_shared<KnownDrawings>();
  std::unique_ptr<DrawnFeatures> drawn_;   ///< of a drawn frame that is made from the one before
  bool is_drawn_ = false;                  ///< the frame, that one or a cold one
  std::unique_ptr<knots::Target> target_;  ///< of the last picture
  std::uint32_t next_id_ = 0;

  double last_mec_ = 0;
  image::Image first_picture_;  ///< of the group, until there is a target of it; if warm frames may follow
  bool last_is_urgent_ = false;
  std::size_t most_functions_ = 0;
  std::size_t captioned_ = 0;  ///< of these, most that captions of film asked for in the group
  int since_softness_ = 0;     ///< frames
};

Tracker::Tracker(const vectorize::Options& cold, const TrackOptions& options, Start first)
    : impl_(std::make_unique<Impl>(cold, options, first)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

std::shared_ptr<const spline::PixelSurface> Tracker::surface() const {
  return impl_->surface();
}

std::vector<std::uint8_t> Tracker::changed_tiles() const {
  return impl_->changed_tiles();
}

bool Tracker::starts_group(const Motion* motion) const {
  return impl_->starts_group(motion);
}

Drawing Tracker::drawing() const {
  return impl_->drawing();
}

std::shared_ptr<KnownDrawings> Tracker::known_drawings() const {
  return impl_->known_drawings();
}

document::FrameModel Tracker::next(const image::Image& picture, const Motion* motion, FrameReport* report,
                                   MadeAhead ahead) {
  vectorize::check_picture(picture);
  FrameReport own;
  return impl_->next(picture, motion, report ? *report : own, std::move(ahead));
}

}  // namespace knotreel::track
