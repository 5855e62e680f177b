#include "knotreel/vectorize/vectorize.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>

#include "knotreel/base/error.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/fit/descend.h"
#include "knotreel/fit/edge_colours.h"
#include "knotreel/fit/pixel_places.h"
#include "knotreel/knots/idle_knots.h"
#include "knotreel/knots/link_choice.h"
#include "knotreel/knots/place.h"
#include "knotreel/knots/refine.h"
#include "knotreel/mesh/triangulate.h"
#include "knotreel/param/parametrized_image.h"
#include "knotreel/raster/edge_softness.h"
#include "vectorize/check_options.h"
#include "vectorize/feature_budget.h"
#include "vectorize/first_knots.h"
#include "vectorize/half_rows.h"
#include "vectorize/initial_mesh.h"

namespace knotreel::vectorize {

namespace {

using mesh::EditableMesh;
using mesh::KnotIndex;

// Of idle knots in a round of refinement: more go at once than in a video, where each change is seen.
constexpr knots::SwapOptions kSwap{.ratio = 10, .share = 0.1};

class Timer {
 public:
  /// Milliseconds since the last call.
  double lap() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

class Run {
 public:
  Run(const image::Image& picture, const Options& options, const Observer& observer)
      : picture_(picture), options_(options), observer_(observer) {
    progress_.picture = &picture_;
    max_functions_ = most_control_points(options, picture.pixel_count());
  }

  Vectorization run() {
    begin_round("round 1");
    last_round_ = options_.rounds == 1;
    if (options_.features) find_features();
    map_features();
    place_knots();
    fit();
    end_round();
    for (int round = 2; round <= options_.rounds && !good_enough(); ++round) {
      begin_round("round " + std::to_string(round));
      last_round_ = round == options_.rounds;
      if (!refine(round)) {
        report_.rounds.pop_back();
        break;
      }
      fit();
      end_round();
    }
    if (options_.descent_steps > 0) {
      begin_round("descent");
      if (full_fit_ && steering_.image->height != picture_.height) {
        surface_.fit = fit::fit_colours(spline::Basis(surface_.space), steering_, from_last_fit());
        full_fit_ = false;
      }
      descend();
      end_round();
    }
    begin_round("final");
    finish();
    end_round();
    return {std::move(model_), std::move(report_), fitted()};
  }

 private:
  void begin_round(std::string name) {
    report_.rounds.emplace_back();
    report_.rounds.back().name = std::move(name);
    timer_.lap();
  }

  void lap(const char* stage) { report_.rounds.back().milliseconds.emplace_back(stage, timer_.lap()); }

  void end_round() {
    RoundReport& r = report_.rounds.back();
    r.knots = surface_.space->mesh().knots.size();
    r.control_points = surface_.space->function_count();
    r.meg = meg_;
    measure(r);
    model_ = current_model();
    r.raw_bytes = document::raw_accounting_bytes(model_);
    progress_.model = &model_;
    progress_.residual = &surface_.fit.residual;
    show(r.name);
  }

  void show(const std::string& stage) {
    if (!observer_) return;
    progress_.stage = stage;
    observer_(progress_);
    timer_.lap();
  }

  /// MEC and PSNR of the residual, over the pixels that count.
  void measure(RoundReport& r) const {
    const auto channels = static_cast<std::size_t>(picture_.channels);
    const std::span<const float> weights = full_fit_ ? std::span<const float>(weights_) : steering_.weights;
    double length = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < surface_.fit.residual.size() / channels; ++i) {
      if (!weights.empty() && weights[i] < 1) continue;
      double squared = 0;
      for (std::size_t c = 0; c < channels; ++c) {
        const double d = static_cast<double>(surface_.fit.residual[i * channels + c]);
        squared += d * d;
      }
      length += std::sqrt(squared);
      ++count;
    }
    if (count == 0) return;
    r.mec = length / static_cast<double>(count);
    r.psnr =
        10 * std::log10(255.0 * 255.0 * static_cast<double>(count * channels) / surface_.fit.squared_error);
  }

  /// Whether the thresholds are met; by all pixels, since pairs of rows have less noise.
  bool good_enough() {
    const auto met = [&] {
      return report_.rounds.back().mec <= options_.mec && report_.rounds.back().meg <= options_.meg;
    };
    if (!met()) return false;
    if (!full_fit_) {
      fit_all_pixels(spline::Basis(surface_.space));
      measure(report_.rounds.back());
    }
    return met();
  }

  // -- features and parametrization

  void find_features() {
    chains_ = features::detect_features(picture_, options_.detect);
    progress_.detected = &chains_;
    report_.chains = chains_.chains.size();
    for (const auto& c : chains_.chains) report_.feature_pixels += c.points.size();
    lap("detect");
    show("features");
  }

  void fair_features() {
    faired_ = chains_;
    if (faired_.chains.empty()) return;
    if (options_.fairing) features::fair_chains(faired_, options_.fair);
    progress_.faired = &faired_;
    lap("fair");
    show("fairing");
  }

  void correct_colours() {
    corrected_ = options_.colour_correction
                     ? features::correct_colours(picture_, faired_, options_.correction)
                     : picture_;
    progress_.corrected = &corrected_;
    lap("correct");
    show("correction");
  }

  bool has_features() const { return !faired_.chains.empty(); }
  const image::Image& colours() const { return has_features() ? corrected_ : picture_; }

  /// Features, parametrization and the knots on the features, within their share of the control points.
  void map_features() {
    if (!chains_.chains.empty()) limit_features(expected_functions(chains_));
    for (;;) {
      fair_features();
      if (has_features()) {
        const double functions = functions_of_polylines();
        lap("parametrize");
        if (limit_features(functions)) continue;
        correct_colours();
      }
      parametrize();
      if (!has_features() || !limit_features(expected_functions(EditableMesh(start_mesh_), options_.degree)))
        break;
    }
    make_target();
  }

  /// About; 0 if the polylines make no sound mesh. Nearly what it is in the end, and known without the map.
  double functions_of_polylines() const {
    try {
      const mesh::KnotMesh mesh =
          initial_mesh(param::first_polylines(faired_, options_.parametrize), options_.segment_knot_spacing);
      return expected_functions(EditableMesh(mesh), options_.degree);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument) throw;
      return 0;
    }
  }

  /// Drops chains if they cost too many control points. @return whether it did.
  bool limit_features(double functions) {
    const std::size_t before = chains_.chains.size();
    keep_within_budget(picture_, functions, static_cast<double>(max_functions_), options_.feature_share,
                       chains_);
    const std::size_t dropped = before - chains_.chains.size();
    report_.chains_over_budget += dropped;
    return dropped > 0;
  }

  void parametrize() {
    if (!has_features()) {
      parametrization_ = {};
      parametrization_.width = picture_.width;
      parametrization_.height = picture_.height;
      start_mesh_ = initial_mesh(parametrization_, options_.segment_knot_spacing);
      return;
    }
    image_mesh_ = features::make_image_mesh(faired_);
    progress_.image_mesh = &image_mesh_;
    param::ParametrizeReport report;
    parametrization_ = param::parametrize(faired_, image_mesh_, options_.parametrize, &report);
    report_.folds_left = report.folds_left;
    report_.polyline_vertices = parametrization_.vertices.size();
    progress_.parametrization = &parametrization_;
    lap("parametrize");
    show("parametrization");
    try {
      start_mesh_ = initial_mesh(parametrization_, options_.segment_knot_spacing);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument || parametrization_.polylines.empty()) throw;
      drop_features();
    }
  }

  void make_target() {
    if (has_features()) {
      auto image = param::parametrized_image(corrected_, faired_, image_mesh_, parametrization_);
      target_ = std::make_unique<knots::Target>(std::move(image.colours), std::move(image.weights));
      place_pixels();
    } else {
      target_ = std::make_unique<knots::Target>(picture_, std::vector<float>{});
    }
    if (options_.half_rows && picture_.height % 2 == 0 && picture_.height >= 16) {
      half_ = half_rows(full_pixels());
      steering_ = half_.view();
    } else {
      steering_ = full_pixels();
    }
    lap("resample");
  }

  /// Features whose polylines make no sound mesh (never seen) are given up.
  void drop_features() {
    report_.features_dropped = true;
    faired_ = {};
    parametrize();
  }

  /// Pixel centres in the domain as the parametrization has them, and the pixels that features cross.
  void place_pixels() {
    const std::size_t n = picture_.pixel_count();
    places_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 centre{static_cast<double>(i % std::size_t(picture_.width)) + 0.5,
                        static_cast<double>(i / std::size_t(picture_.width)) + 0.5};
      const Vec2 shift = parametrization_.parameter[i] - parametrization_.position[i];
      const Vec2 u = centre + shift;
      places_[i] = {std::clamp(u.x, 0.0, double(picture_.width)),
                    std::clamp(u.y, 0.0, double(picture_.height))};
    }
    weights_.assign(n, 1.0F);
    // initial_mesh() makes the segments in the order of the polylines.
    std::vector<std::uint32_t> segment_of;
    std::uint32_t segments = 0;
    for (const param::Polyline& line : parametrization_.polylines) {
      segment_of.push_back(segments);
      segments += static_cast<std::uint32_t>(line.vertices.size() - (line.closed ? 0 : 1));
    }
    std::vector<std::uint8_t> crossed(n, 0);
    for (const param::CurveSample& s : parametrization_.curve_samples) {
      curves_.push_back({parameter_of(s), s.position});
      curve_segments_.push_back(segment_of[s.polyline] + s.segment);
      const int x = std::clamp(static_cast<int>(s.position.x), 0, picture_.width - 1);
      const int y = std::clamp(static_cast<int>(s.position.y), 0, picture_.height - 1);
      crossed[std::size_t(y) * std::size_t(picture_.width) + std::size_t(x)] = 1;
    }
    weigh(crossed, start_mesh_);
  }

  Vec2 parameter_of(const param::CurveSample& s) const {
    const param::Polyline& line = parametrization_.polylines[s.polyline];
    const Vec2 a = parametrization_.vertices[line.vertices[s.segment]].position;
    const Vec2 b = parametrization_.vertices[line.vertices[(s.segment + 1) % line.vertices.size()]].position;
    return a + s.t * (b - a);
  }

  /// Pixels that features cross count little, with the colour of their side.
  void weigh(const std::vector<std::uint8_t>& crossed, const mesh::KnotMesh& mesh) {
    const std::vector<std::uint8_t> given = fit::clear_edge_colours(corrected_, places_, crossed, mesh);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      weights_[i] = !crossed[i] ? 1.0F : given[i] ? fit::kEdgeWeight : 0.0F;
    }
  }

  // -- knots

  void place_knots() {
    mesh_ = std::make_unique<EditableMesh>(start_mesh_);
    const double share = options_.rounds > 1 ? options_.first_share : 1.0;
    knots::insert_knots(*mesh_, *target_,
                        first_knots(*mesh_, share * static_cast<double>(max_functions_), options_));
    lap("place");
    knots::optimise(*mesh_, *target_, options_.optimise);
    lap("optimise");
    if (options_.optimise.connectivity) knots::remove_slivers(*mesh_, *target_, options_.optimise);
    lap("slivers");
    start_mesh_ = mesh_->to_mesh();
    progress_.knot_mesh = &start_mesh_;
    show("knots");
  }

  /// Inserts knots where the last fit was worst, and moves there those that are idle elsewhere. @return
  /// whether there were any.
  bool refine(int round) {
    const int left = options_.rounds - round + 1;
    const double used = static_cast<double>(surface_.space->function_count());
    const double budget = used + (static_cast<double>(max_functions_) - used) / left;
    const double per_knot = used / static_cast<double>(surface_.space->mesh().knots.size());
    const double wanted = std::max(0.0, (budget - used) / per_knot);
    knots::RefineOptions refine;
    refine.max_knots = static_cast<std::size_t>(0.98 * wanted);
    refine.min_distance = options_.optimise.min_distance;
    mesh_ = std::make_unique<EditableMesh>(surface_.space->mesh());
    std::vector<KnotIndex> inserted = refine_curves();
    curves_refined_ = !inserted.empty();
    refine.max_knots -= std::min(refine.max_knots, inserted.size());
    const std::vector<float> errors = squared_errors();
    refine.max_knots += knots::remove_idle_knots(
        *mesh_, *target_, knots::sorted_face_errors(*mesh_, errors, picture_.width, picture_.height), kSwap);
    const std::vector<KnotIndex> off_curves =
        knots::refine_knots(*mesh_, errors, places_, picture_.width, picture_.height, refine);
    inserted.insert(inserted.end(), off_curves.begin(), off_curves.end());
    lap("insert");
    if (inserted.empty()) return false;
    knots::OptimiseOptions local = options_.optimise;
    local.rounds = std::min(local.rounds, 1);  // most of the mesh is as good as it gets
    knots::optimise(*mesh_, *target_, local, knots::rings_around(*mesh_, inserted, 2));
    lap("optimise");
    return true;
  }

  /// Knots on features, where the geometry misses the curves by more than a pixel.
  std::vector<KnotIndex> refine_curves() {
    std::vector<knots::CurveError> errors;
    if (!curves_refined_) return {};  // the errors are those of an earlier round
    for (std::size_t i = 0; i < curve_errors_.size(); ++i) {
      errors.push_back({curve_segments_[i], curves_[i].parameter, curve_errors_[i]});
    }
    return knots::refine_features(*mesh_, errors, std::max(1.0, options_.meg),
                                  options_.optimise.min_distance);
  }

  /// Squared errors of all pixels.
  std::vector<float> squared_errors() const {
    const auto channels = static_cast<std::size_t>(picture_.channels);
    const auto width = static_cast<std::size_t>(picture_.width);
    const std::size_t rows_per_row = full_fit_ || steering_.image->height == picture_.height ? 1 : 2;
    std::vector<float> squared(picture_.pixel_count(), 0);
    for (std::size_t i = 0; i < squared.size(); ++i) {
      const std::size_t from = i / width / rows_per_row * width + i % width;
      for (std::size_t c = 0; c < channels; ++c) {
        const float d = surface_.fit.residual[from * channels + c];
        squared[i] += d * d;
      }
    }
    return squared;
  }

  // -- surfaces

  fit::Pixels full_pixels() const { return {.image = &colours(), .weights = weights_, .places = places_}; }

  void make_space() {
    mesh::KnotMesh mesh = mesh_->to_mesh();
    surface_.space =
        options_.picture_links && last_round_
            ? std::make_shared<const spline::SplineSpace>(
                  std::move(mesh), options_.degree, knots::picture_links(*target_), spline::LinkOrder::kAny)
            : std::make_shared<const spline::SplineSpace>(std::move(mesh), options_.degree);
  }

  /// Takes away the knots inserted last until the bound on the control points holds.
  void keep_bound() {
    while (surface_.space->function_count() > max_functions_) {
      const std::size_t excess = surface_.space->function_count() - max_functions_;
      // A knot takes two or three functions with it; to build the space once more costs more than a few
      // knots.
      const std::size_t knots = excess / 2 + 4;
      std::size_t left = knots;
      for (std::size_t k = mesh_->knot_slots(); k-- > 0 && left > 0;) {
        if (mesh_->is_knot(static_cast<KnotIndex>(k)) && mesh_->remove(static_cast<KnotIndex>(k))) --left;
      }
      if (left == knots) return;  // no free knot is left
      make_space();
    }
  }

  void fit() {
    make_space();
    keep_bound();
    lap("links");
    const spline::Basis basis(surface_.space);
    displacement_.assign(surface_.space->geometry_count(), Vec2{});
    // Only knots on curves change how well the geometry follows them, and only further rounds ask for that.
    if (has_features() && curves_refined_ && !last_round_) {
      fit_geometry(spline::PixelValues(basis, picture_.width, picture_.height, places_));
    }
    surface_.fit = fit::fit_colours(basis, steering_, options_.colour);
    full_fit_ = false;
    lap("colours");
  }

  /// To fit the colours over the same space again.
  fit::ColourFitOptions from_last_fit() const {
    fit::ColourFitOptions colour = options_.colour;
    colour.start = surface_.fit.control;
    return colour;
  }

  /// @param basis of the space of the last fit.
  void fit_all_pixels(const spline::Basis& basis) {
    surface_.fit = fit::fit_colours(basis, full_pixels(), from_last_fit());
    full_fit_ = true;
    lap("colours");
  }

  void fit_geometry(const spline::PixelValues& values) {
    displacement_.assign(surface_.space->geometry_count(), Vec2{});
    if (!has_features()) return;
    displacement_ = fit::fit_geometry(values, places_, curves_, options_.geometry);
    measure_curves(values.basis());
    lap("geometry");
  }

  void measure_curves(const spline::Basis& basis) {
    curve_errors_ = fit::geometry_errors(basis, displacement_, curves_);
    meg_ = curve_errors_.empty() ? 0
                                 : std::accumulate(curve_errors_.begin(), curve_errors_.end(), 0.0) /
                                       static_cast<double>(curve_errors_.size());
  }

  void descend() {
    fit::DescentOptions descent;
    descent.steps = options_.descent_steps;
    descent.min_distance = options_.optimise.min_distance;
    descent.colour = options_.colour;
    descent.on_step = [this] {
      if (observer_) observer_({.stage = "descent step", .picture = &picture_});
    };
    surface_ = fit::descend(std::move(surface_), steering_, descent);
    lap("descend");
  }

  /// Goes over to the space as documents have it.
  void store_space() {
    const document::StoredSpace stored = document::stored_space(surface_.space, options_.knot_bits);
    const auto channels = static_cast<std::size_t>(picture_.channels);
    std::vector<double> control;
    control.reserve(stored.function_of.size() * channels);
    for (const spline::FunctionIndex f : stored.function_of) {
      for (std::size_t c = 0; c < channels; ++c) control.push_back(surface_.fit.control[f * channels + c]);
    }
    surface_.space = stored.space;
    surface_.fit.control = std::move(control);
  }

  void round_displacement() { document::round_displacement(displacement_, options_.displacement_step); }

  /// The last geometry, and colours at the very places where the renderer will look for them.
  void finish() {
    store_space();
    basis_ = std::make_shared<const spline::Basis>(surface_.space);
    const spline::Basis& basis = *basis_;
    if (has_features()) {
      const spline::PixelValues values(basis, picture_.width, picture_.height, places_);
      lap("basis");
      fit_geometry(values);
      round_displacement();
      report_.geometry_folds = fit::unfold_geometry(basis, displacement_);
      round_displacement();
      measure_curves(basis);
      lap("unfold");
      places_ = fit::pixel_places(basis, displacement_, picture_.width, picture_.height);
      crossed_ = fit::crossed_pixels(basis, displacement_, picture_.width, picture_.height);
      weigh(crossed_, surface_.space->mesh());
      lap("invert");
    }
    fit_all_pixels(basis);
    if (has_features()) find_edge_softness();
  }

  void find_edge_softness() {
    auto surface = std::make_shared<spline::PixelSurface>();
    surface->basis = basis_;
    surface->colours.resize(corrected_.samples.size());
    std::transform(corrected_.samples.begin(), corrected_.samples.end(), surface_.fit.residual.begin(),
                   surface->colours.begin(), std::minus());
    edge_softness_ = raster::fitting_edge_softness(current_model(), picture_, basis_, std::move(surface));
    lap("softness");
  }

  document::FrameModel current_model() const {
    document::FrameModel model;
    model.space = surface_.space;
    model.displacement = displacement_;
    model.channels = picture_.channels;
    model.colour = surface_.fit.control;
    model.edge_softness = edge_softness_;
    return model;
  }

  /// After finish(). Takes what it needs.
  Fitted fitted() { return {std::move(basis_), std::move(places_), std::move(crossed_)}; }

  const image::Image& picture_;
  const Options& options_;
  const Observer& observer_;
  Progress progress_;
  Report report_;
  Timer timer_;
  std::size_t max_functions_ = 0;

  features::FeatureChains chains_;
  features::FeatureChains faired_;
  image::Image corrected_;
  features::ImageMesh image_mesh_;
  param::Parametrization parametrization_;
  std::vector<Vec2> places_;           ///< empty without features
  std::vector<float> weights_;         ///< empty without features
  std::vector<std::uint8_t> crossed_;  ///< by the features of the last geometry; empty without
  std::vector<fit::CurvePoint> curves_;
  std::vector<std::uint32_t> curve_segments_;  ///< of the knot mesh, parallel to curves_
  std::vector<double> curve_errors_;           ///< pixels, parallel to curves_
  bool curves_refined_ = true;                 ///< knots were put on curves after the last geometry fit

  PixelData half_;
  fit::Pixels steering_;   ///< what rounds and descent are fitted to: all pixels, or pairs of rows
  bool full_fit_ = false;  ///< whether the residual is of all pixels

  bool last_round_ = false;

  std::unique_ptr<knots::Target> target_;
  mesh::KnotMesh start_mesh_;
  std::unique_ptr<EditableMesh> mesh_;
  fit::ColourSurface surface_;
  std::shared_ptr<const spline::Basis> basis_;  ///< of the final surface
  std::vector<Vec2> displacement_;
  double meg_ = 0;
  double edge_softness_ = 0;
  document::FrameModel model_;
};

void check_picture(const image::Image& picture) {
  const auto refuse = [](const char* what) { throw Error(ErrorKind::kInvalidArgument, what); };
  if (picture.width < 1 || picture.height < 1) refuse("cannot vectorize a picture without pixels");
  const auto is_number = [](float sample) { return std::isfinite(sample); };
  if (!std::all_of(picture.samples.begin(), picture.samples.end(), is_number))
    refuse("cannot vectorize a picture with samples that are not finite");
}

}  // namespace

Vectorization vectorize_picture(const image::Image& picture, const Options& options,
                                const Observer& observer) {
  check_picture(picture);
  check_options(options);
  return Run(picture, options, observer).run();
}

}  // namespace knotreel::vectorize
