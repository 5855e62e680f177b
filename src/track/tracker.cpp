#include "knotreel/track/tracker.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <unordered_set>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/fit/descend.h"
#include "knotreel/fit/knot_gradient.h"
#include "knotreel/knots/refine.h"
#include "knotreel/mesh/insert_polylines.h"
#include "knotreel/raster/edge_softness.h"
#include "knotreel/track/group_rule.h"
#include "knotreel/track/idle_knots.h"
#include "track/bend_geometry.h"
#include "track/births.h"
#include "track/carried_geometry.h"
#include "track/carried_links.h"
#include "track/cold_frame.h"
#include "track/colour_coarseness.h"
#include "track/difficulty.h"
#include "track/fit_watch.h"
#include "track/foresee.h"
#include "track/knot_motion.h"
#include "track/local_error.h"
#include "track/matching.h"
#include "track/placed_pixels.h"
#include "track/quality.h"
#include "track/settle.h"
#include "track/snap.h"
#include "track/temporal_target.h"
#include "vectorize/feature_budget.h"

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

constexpr double kLeastShare = 0.25;    // of what features may use, that a group without any may come to
constexpr double kFunctionsOfKnot = 3;  // about: the least by which a group grows
constexpr int kFramesToBend = 16;
constexpr int kSoftnessInterval = 16;    // frames; the cold one's is of curves that lie better
constexpr std::size_t kBoundMargin = 2;  // knots that go at once above the bound: a space anew is dearer
constexpr double kBoundLeeway = 0.003;  // of the bound, that new knots leave: links that change need room too

using mesh::EditableMesh;
using mesh::KnotIndex;
using mesh::KnotMesh;

/// Where the geometry of a surface takes the knots of a mesh in the image.
std::vector<Vec2> image_positions(const spline::Basis& basis, std::span<const Vec2> displacement,
                                  const KnotMesh& mesh) {
  std::vector<Vec2> points;
  for (const mesh::Knot& k : mesh.knots) points.push_back(k.position);
  if (std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; }))
    return points;
  return fit::image_points(basis, displacement, std::move(points));
}

/// Adds the segments that could not follow their edges to the lost ones: in the wrong place they harm.
bool give_up_stuck(const CarryReport& report, std::vector<std::uint8_t>& lost) {
  bool any = false;
  for (const std::size_t i : report.stuck) {
    any = any || !lost[i];
    lost[i] = 1;
  }
  return any;
}

double share_alive(const KnotMesh& before, const KnotMesh& now) {
  std::unordered_set<std::uint32_t> ids;
  for (const mesh::Knot& k : now.knots) ids.insert(static_cast<std::uint32_t>(k.id));
  std::size_t alive = 0;
  for (const mesh::Knot& k : before.knots) alive += ids.count(static_cast<std::uint32_t>(k.id));
  return static_cast<double>(alive) / static_cast<double>(before.knots.size());
}

}  // namespace

class Tracker::Impl {
 public:
  Impl(const vectorize::Options& cold, const TrackOptions& options, Start first)
      : cold_(cold),
        options_(options),
        groups_(options, first),
        watch_(options),
        settling_(SettleOptions{}) {}

  document::FrameModel next(const image::Image& picture, const Motion* motion, FrameReport& report,
                            std::shared_ptr<ColdFrame> cold) {
    report_ = &report;
    report = {};
    clock_ = std::chrono::steady_clock::now();
    report.start = groups_.next(motion);
    most_functions_ = vectorize::most_control_points(cold_, picture.pixel_count());
    if (report.start == Start::kWarm && motion->repeated) {
      report.survival = 1;
      report.psnr = watch_.last();
      report.mec = last_mec_;
    } else if (report.start == Start::kWarm) {
      make_warm(picture, *motion);
      const bool look = report.mec > cold_.mec && watch_.is_time_to_look(report.psnr);
      cold = look ? better_cold_frame(picture) : nullptr;
      if (cold) {
        report.start = Start::kDrift;
        report.survival = 0;  // what was done before was in vain
        report.changes = {};
        groups_.restart();
      } else {
        const bool needs_mending = watch_.needs_mending(report.psnr, report.changes.repairs > 0);
        watch_.end_frame(report.psnr, report.changes.repairs > 0);
        coarseness_.end_frame(report.psnr);
        last_mec_ = report.mec;
        end_frame(picture, needs_mending);
      }
    }
    if (report.start != Start::kWarm) {
      if (report.start != Start::kDrift) target_.reset();  // it is that of the frame before
      take_over(cold ? std::move(*cold) : std::move(*make_cold_frame(picture, cold_, options_.colour_step)));
      start_group(picture);
    }
    report.knots = space_->mesh().knots.size();
    report.control_points = space_->function_count();
    return model(picture, report.start != Start::kWarm);
  }

  std::shared_ptr<const spline::PixelSurface> surface() const { return surface_; }

 private:
  void lap(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    report_->milliseconds.emplace_back(stage,
                                       std::chrono::duration<double, std::milli>(now - clock_).count());
    clock_ = now;
  }

  // -- cold frames

  void take_over(ColdFrame&& cold) {
    space_ = std::move(cold.space);
    mesh_ = space_->mesh();
    displacement_ = std::move(cold.displacement);
    edge_softness_ = cold.edge_softness;
    basis_ = std::move(cold.basis);
    seen_ = std::move(cold.placed);
    colours_ = std::move(cold.colours);
    surface_ = std::move(cold.surface);
    report_->milliseconds.insert(report_->milliseconds.end(), cold.milliseconds.begin(),
                                 cold.milliseconds.end());
    clock_ = std::chrono::steady_clock::now();
  }

  void start_group(const image::Image& picture) {
    measure();
    if (options_.warm_start && !target_) make_target(picture);
    watch_.start_group(report_->psnr);
    coarseness_.start_group(report_->psnr);
    colour_step_ = options_.colour_step;
    group_functions_ = space_->function_count();
    group_features_ = feature_length(space_->mesh());
    since_births_ = 0;
    since_rework_ = options_.rework_interval;
    since_bend_ = options_.bend_interval;
    since_softness_ = kSoftnessInterval;
    frames_to_bend_ = 0;
    has_new_features_ = false;
    next_id_ = EditableMesh(space_->mesh()).next_id();
    settling_.clear();
    last_mec_ = report_->mec;
    if (!options_.warm_start) return;
    parallel_invoke(
        [&] {
          last_cold_ = {report_->psnr, difficulty_now()};
        },
        [&] { end_frame(picture, false); });
  }

  void make_target(const image::Image& picture) {
    target_ = std::make_unique<knots::Target>(picture, std::vector<float>{});
    difficulty_.reset();
  }

  /// Of the picture of the target; found when first asked for.
  double difficulty_now() {
    if (!difficulty_) difficulty_ = difficulty(*target_, cold_, most_functions_);
    return *difficulty_;
  }

  void look_at(const image::Image& picture) {
    seen_ = place_pixels(basis_, displacement_, picture, edge_softness_);
    lap("places");
  }

  /// Of the basis, at the places of what is seen.
  const spline::PixelValues& values() const { return seen_.placed->values(); }

  void measure() {
    const Quality quality = quality_of(colours_.residual, seen_.weights, seen_.picture.channels);
    report_->mec = quality.mec;
    report_->psnr = quality.psnr;
  }

  // -- warm frames

  void make_warm(const image::Image& picture, const Motion& motion) {
    const std::unique_ptr<knots::Target> target_before = std::move(target_);
    KnotMesh carried;
    std::optional<LinkMemory> links;
    std::optional<FaceErrors> errors_before;
    parallel_invoke([&] { carried = carried_mesh(motion); },
                    [&] {
                      make_target(picture);
                      links.emplace(*space_);
                      errors_before.emplace(mesh_, *target_before);
                    });
    lap("carry");
    carried = refilled(carried, *errors_before);
    lap("foresee");
    frame_before_ = {space_, colours_.control, std::move(colours_.residual), std::move(seen_.weights)};
    take_over(carried, *links);
    bend_curves(*motion.now);
    fit(picture, motion);
    measure();
    // Curves that were left alone may be why: they are bent in all frames for a while.
    if (since_bend_ > 0 && watch_.has_fallen(report_->psnr)) frames_to_bend_ = kFramesToBend;
    for (int pass = 0; pass < options_.most_repairs && watch_.needs_repair(report_->psnr); ++pass) {
      next_mesh_ = mesh_;
      rework(picture, true);
      take_over(next_mesh_, LinkMemory(*space_));
      fit(picture, motion);
      measure();
      ++report_->changes.repairs;
    }
    report_->survival = share_alive(frame_before_.space->mesh(), space_->mesh());
    if (++since_softness_ >= kSoftnessInterval) update_edge_softness(picture);
  }

  /// Curves lie less well in warm frames than in the cold one, and pictures get out of focus. Half of the
  /// way, so that edges do not flicker.
  void update_edge_softness(const image::Image& picture) {
    since_softness_ = 0;
    const double fitting = raster::fitting_edge_softness(model(picture, false), picture, basis_, surface_);
    edge_softness_ = (edge_softness_ + fitting) / 2;
    lap("softness");
  }

  /// Where the knots of the mesh prepared for this frame have gone.
  KnotMesh carried_mesh(const Motion& motion) {
    const std::vector<Vec2> points = image_positions(*basis_, displacement_, next_mesh_);
    std::vector<Vec2> moves = knot_motion(next_mesh_, points, motion);
    SnapResult snapped =
        snap_to_edges(*basis_, displacement_, next_mesh_, moves, seen_.picture, *motion.before, *motion.now);
    for (std::size_t k = 0; k < moves.size(); ++k) moves[k] = moves[k] + snapped.moves[k];
    const std::vector<Vec2> targets = knot_targets(next_mesh_, moves);
    KnotMesh carried = carry_mesh(next_mesh_, targets, snapped.lost, options_.carry, &report_->changes.carry);
    if (!give_up_stuck(report_->changes.carry, snapped.lost)) return carried;
    return carry_mesh(next_mesh_, targets, snapped.lost, options_.carry, &report_->changes.carry);
  }

  /// A carried mesh with knots for those that were lost on the way, where the picture asks for them; and for
  /// idle ones, if the frame would be much worse than the one before.
  KnotMesh refilled(const KnotMesh& carried, const FaceErrors& errors_before) {
    EditableMesh mesh(carried, next_id_);
    const Foresight foresight(mesh, *target_, errors_before);
    std::size_t count = next_mesh_.knots.size() - carried.knots.size();
    if (foresight.loss() > options_.swap_above) {
      const std::size_t idle = remove_idle_knots(mesh, *target_, foresight.growths(), options_.urgent_swap);
      report_->changes.swapped += idle;
      count += idle;
    }
    const std::vector<KnotIndex> fresh = foresight.insert(mesh, count, options_.carry.min_distance);
    next_id_ = mesh.next_id();
    report_->changes.inserted += fresh.size();
    optimise_around(mesh, fresh);
    return mesh.to_mesh();
  }

  /// Moves new knots to where the picture wants them. Their neighbours stay, unless much is new: to disturb
  /// knots that have settled is more flicker and bytes for the same error.
  void optimise_around(EditableMesh& mesh, const std::vector<KnotIndex>& fresh) const {
    if (fresh.empty() || options_.inserted_steps == 0) return;
    knots::OptimiseOptions local = cold_.optimise;
    local.rounds = 1;
    local.steps = std::min(local.steps, options_.inserted_steps);
    const double share = static_cast<double>(fresh.size()) / static_cast<double>(mesh.knot_count());
    knots::optimise(mesh, *target_, local,
                    knots::rings_around(mesh, fresh, share > options_.much_new ? 1 : 0));
  }

  /// A cold model if that is worth a new group; else the picture has become harder, which is no reason to
  /// look again soon.
  std::shared_ptr<ColdFrame> better_cold_frame(const image::Image& picture) {
    watch_.looked(report_->psnr);
    const double expected = expected_psnr();
    lap("difficulty");
    if (expected < report_->psnr + options_.restart_gain) return nullptr;
    std::shared_ptr<ColdFrame> cold = make_cold_frame(picture, cold_, options_.colour_step);
    lap("cold");
    const Quality quality = quality_of(cold->colours.residual, cold->placed.weights, picture.channels);
    if (quality.psnr > report_->psnr + options_.restart_gain) return cold;
    watch_.made_cold_frame_in_vain();
    last_cold_ = {quality.psnr, difficulty_now()};
    return nullptr;
  }

  /// Of a cold frame, about: that of the last one, less what the picture has become harder since.
  double expected_psnr() {
    constexpr double kLeast = 1;  // squared levels, of the whole picture
    return last_cold_.psnr - 10 * std::log10((difficulty_now() + kLeast) / (last_cold_.difficulty + kLeast));
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
      if (remove_idle_knots(fewer, *target_, {}, {}, surplus) == 0) break;
      space = over(fewer.to_mesh());
    }
    parallel_invoke(
        [&] {
          displacement_ = carried_displacement(*space_, displacement_, *space);
          round_displacement();
        },
        [&] { basis_ = std::make_shared<const spline::Basis>(space); });
    space_ = std::move(space);
    lap("space");
  }

  void round_displacement() { document::round_displacement(displacement_, options_.displacement_step); }

  /// Bends the geometry to the edges once in a while, if the curves miss them by too much.
  void bend_curves(const motion::Luma& now) {
    frames_to_bend_ = std::max(0, frames_to_bend_ - 1);
    const int interval = frames_to_bend_ > 0 ? 1 : options_.bend_interval;
    if (++since_bend_ < interval && !has_new_features_) return;
    since_bend_ = 0;
    const EdgePoints edges = find_edge_points(*basis_, displacement_, now);
    if (edges.rms <= options_.curve_error && !has_new_features_) return;
    has_new_features_ = false;
    bend_geometry(*basis_, edges.points, displacement_);
    round_displacement();
    fit::unfold_geometry(*basis_, displacement_);
    round_displacement();
    lap("geometry");
  }

  void fit(const image::Image& picture, const Motion& motion) {
    std::vector<std::uint32_t> match;
    parallel_invoke([&] { look_at(picture); },
                    [&] { match = match_functions(*frame_before_.space, *space_); });
    const image::Image wanted = temporal_target(seen_.picture, frame_before_.residual, frame_before_.weights,
                                                motion, options_.temporal_weight);
    fit::Pixels pixels = seen_.view();
    pixels.image = &wanted;
    fit::ColourFitOptions colour = cold_.colour;
    colour.find_residual = false;
    const std::vector<double> before = colours_before(match);
    colour.start = before;
    colour.step = colour_step_ = options_.colour_step * options_.delta_coarseness * coarseness_.factor();
    const std::vector<double> reluctance = reluctance_to_change(picture);
    colour.reluctance = reluctance;
    colours_ = fit::fit_colours(values(), pixels, colour);
    surface_ = surface_at(seen_, colours_.control);
    colours_.residual = residual_of(seen_, *surface_);
    lap("colours");
  }

  /// Colours of control points in the frame before; NaN for those that were not there.
  /// @param match of the functions with those of the frame before.
  std::vector<double> colours_before(const std::vector<std::uint32_t>& match) const {
    const std::size_t channels = frame_before_.control.size() / frame_before_.space->function_count();
    std::vector<double> colours(match.size() * channels, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t f = 0; f < match.size(); ++f) {
      if (match[f] == kNoMatch) continue;
      std::copy_n(frame_before_.control.begin() + static_cast<std::ptrdiff_t>(match[f] * channels), channels,
                  colours.begin() + static_cast<std::ptrdiff_t>(f * channels));
    }
    return colours;
  }

  /// By function. What is hit well shows what is left over from the frame before, and has little to flicker.
  std::vector<double> reluctance_to_change(const image::Image& picture) const {
    std::vector<double> result =
        local_errors(*space_, frame_before_.residual, picture.width, picture.height, picture.channels);
    for (double& r : result) r = options_.reluctance * std::min(1.0, r / options_.reluctance_error);
    return result;
  }

  /// Leaves the mesh that the next frame starts from; once in a while, and where the fit has fallen,
  /// reworked.
  void end_frame(const image::Image& picture, bool urgent) {
    next_mesh_ = mesh_;
    grow_group();
    ++since_births_;
    if (++since_rework_ < options_.rework_interval && !urgent) return;
    since_rework_ = 0;
    rework(picture, urgent);
  }

  /// Knots of the next mesh go a step against the gradient of the error, and those that are lost or idle come
  /// back where the error is. @param urgent the error has risen.
  void rework(const image::Image& picture, bool urgent) {
    const std::vector<float> errors = squared_errors();
    if (options_.settle) {
      if (urgent) settling_.wake();
      std::vector<Vec2> moves = settling_.moves(
          next_mesh_, fit::knot_gradient(values(), seen_.view(), colours_, settling_.awake(next_mesh_)),
          std::accumulate(errors.begin(), errors.end(), 0.0));
      fit::limit_moves(*space_, mesh_, options_.carry.min_distance, moves);
      const std::vector<Vec2> moved = fit::moved_positions(next_mesh_, moves);
      for (std::size_t k = 0; k < moved.size(); ++k) next_mesh_.knots[k].position = moved[k];
    }
    lap("settle");
    EditableMesh mesh(next_mesh_, next_id_);
    const double functions_before = vectorize::expected_functions(mesh, cold_.degree);
    std::vector<KnotIndex> born;
    if (!urgent) born = add_features(picture, errors, mesh);
    lap("births");
    refill(picture, errors, urgent, mesh, born,
           vectorize::expected_functions(mesh, cold_.degree) - functions_before);
    lap("refill");
  }

  /// Features that the model lacks, where ones that got lost since the group began leave room for them.
  /// @return their knots.
  std::vector<KnotIndex> add_features(const image::Image& picture, std::span<const float> errors,
                                      EditableMesh& mesh) {
    std::vector<KnotIndex> born;
    if (!cold_.features || options_.birth_interval < 1 || since_births_ < options_.birth_interval)
      return born;
    since_births_ = 0;
    const double least = kLeastShare * cold_.feature_share * static_cast<double>(group_functions_);
    const double room = std::max(least / vectorize::kFunctionsPerFeaturePixel, group_features_) -
                        feature_length(space_->mesh());
    const auto lines =
        missing_features(*basis_, displacement_, seen_, picture, errors, cold_.detect, room, options_.birth);
    for (const std::vector<KnotIndex>& knots : mesh::insert_polylines(mesh, lines)) {
      born.insert(born.end(), knots.begin(), knots.end());
      report_->changes.features_born += knots.empty() ? 0 : 1;
    }
    has_new_features_ = !born.empty();
    return born;
  }

  /// A group gets more control points while the error is above what is asked for and the bound leaves room:
  /// the content has become harder. A cold frame would have used them.
  void grow_group() {
    if (options_.growth <= 0 || report_->mec <= options_.grow_above * cold_.mec) return;
    const double more = std::max(kFunctionsOfKnot, options_.growth * static_cast<double>(group_functions_));
    const std::size_t grown = group_functions_ + static_cast<std::size_t>(more);
    group_functions_ = std::max(group_functions_, std::min(grown, most_functions_));
  }

  /// Puts knots where the error is: as many as got lost, and those that are idle elsewhere.
  void refill(const image::Image& picture, std::span<const float> errors, bool urgent, EditableMesh& mesh,
              const std::vector<KnotIndex>& born, double born_functions) {
    const double functions = static_cast<double>(space_->function_count());
    const double per_knot = functions / static_cast<double>(space_->mesh().knots.size());
    const double wanted = std::min(static_cast<double>(group_functions_),
                                   (1 - kBoundLeeway) * static_cast<double>(most_functions_));
    const double missing = (wanted - functions - born_functions) / per_knot;
    const std::size_t removed =
        remove_idle_knots(mesh, *target_, sorted_face_errors(mesh, errors, picture.width, picture.height),
                          urgent ? options_.urgent_swap : options_.swap,
                          born.empty() ? 0 : static_cast<std::size_t>(std::max(0.0, -missing)));
    report_->changes.swapped += removed;
    knots::RefineOptions refine;
    refine.max_knots = static_cast<std::size_t>(std::max(0.0, missing + static_cast<double>(removed)));
    refine.min_distance = options_.carry.min_distance;
    std::vector<KnotIndex> fresh =
        knots::refine_knots(mesh, errors, seen_.placed->places(), picture.width, picture.height, refine);
    report_->changes.inserted += fresh.size();
    fresh.insert(fresh.end(), born.begin(), born.end());
    next_id_ = mesh.next_id();
    optimise_around(mesh, fresh);
    next_mesh_ = mesh.to_mesh();
  }

  std::vector<float> squared_errors() const {
    const auto channels = static_cast<std::size_t>(seen_.picture.channels);
    const std::vector<float>& residual = colours_.residual;
    std::vector<float> squared(residual.size() / channels);
    const auto width = static_cast<std::size_t>(seen_.picture.width);
    parallel_for(squared.size() / width, [&](std::size_t row) {
      for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
        float sum = 0;
        for (std::size_t c = 0; c < channels; ++c)
          sum += residual[i * channels + c] * residual[i * channels + c];
        squared[i] = seen_.weights.empty() || seen_.weights[i] >= 1 ? sum : 0;
      }
    });
    return squared;
  }

  document::FrameModel model(const image::Image& picture, bool keyframe) const {
    document::FrameModel model;
    model.space = space_;
    model.displacement = displacement_;
    model.channels = picture.channels;
    model.colour = colours_.control;
    if (!keyframe) model.colour_step = colour_step_;
    model.edge_softness = edge_softness_;
    model.keyframe = keyframe;
    return model;
  }

  vectorize::Options cold_;
  TrackOptions options_;
  GroupRule groups_;
  FitWatch watch_;
  ColourCoarseness coarseness_;
  FrameReport* report_ = nullptr;
  std::chrono::steady_clock::time_point clock_;

  std::shared_ptr<const spline::SplineSpace> space_;
  std::vector<Vec2> displacement_;
  double edge_softness_ = 0;  ///< found when the group began
  double colour_step_ = 0;    ///< of colours_, levels
  PlacedPixels seen_;
  fit::ColourFit colours_;                               ///< the residual is that of seen_
  std::shared_ptr<const spline::PixelSurface> surface_;  ///< at seen_
  std::shared_ptr<const spline::Basis> basis_;           ///< of space_
  /// Of space_, but with the knots where they are before they are rounded to the grid: motion of less than
  /// a step of it is not lost.
  KnotMesh mesh_;
  KnotMesh next_mesh_;
  struct {
    std::shared_ptr<const spline::SplineSpace> space;
    std::vector<double> control;
    std::vector<float> residual;  ///< of what was seen
    std::vector<float> weights;
  } frame_before_;
  Settling settling_;
  std::unique_ptr<knots::Target> target_;  ///< of the last picture
  std::optional<double> difficulty_;       ///< of that
  std::uint32_t next_id_ = 0;

  struct {
    double psnr = 0;
    double difficulty = 0;
  } last_cold_;  ///< that began the group, or was made in vain
  double last_mec_ = 0;
  std::size_t group_functions_ = 0;
  std::size_t most_functions_ = 0;
  double group_features_ = 0;      ///< length of the feature polylines at its start, pixels
  int since_births_ = 0;           ///< frames
  int since_rework_ = 0;           ///< frames
  int since_bend_ = 0;             ///< frames
  int since_softness_ = 0;         ///< frames
  int frames_to_bend_ = 0;         ///< in which curves are looked at whatever the interval
  bool has_new_features_ = false;  ///< that were never bent to their edges
};

Tracker::Tracker(const vectorize::Options& cold, const TrackOptions& options, Start first)
    : impl_(std::make_unique<Impl>(cold, options, first)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

std::shared_ptr<const spline::PixelSurface> Tracker::surface() const {
  return impl_->surface();
}

document::FrameModel Tracker::next(const image::Image& picture, const Motion* motion, FrameReport* report,
                                   std::shared_ptr<ColdFrame> cold) {
  FrameReport own;
  return impl_->next(picture, motion, report ? *report : own, std::move(cold));
}

}  // namespace knotreel::track
