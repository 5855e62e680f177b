// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/mapped_picture.h"

#include <algorithm>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/features/corners.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/features/prefer_points.h"
#include "knotreel/features/scale.h"
#include "knotreel/features/side_ends.h"
#include "knotreel/features/space_points.h"
#include "knotreel/fit/squared_errors.h"
#include "knotreel/param/parametrized_image.h"
#include "vectorize/feature_budget.h"
#include "vectorize/initial_mesh.h"

namespace knotreel::vectorize {

namespace {

using mesh::EditableMesh;

// Of the control points, for features with finer polylines.
constexpr double kShareOfFine = 0.6;

constexpr std::size_t kManyPixels = std::size_t{1} << 20U;

// Pixels of the picture given.
constexpr double kShortSegment = 3;
constexpr double kShortestSegment = 0.2;  // that can be told from nothing on grids of knots
constexpr double kLeastSpace = 0.25;      // from a point of a curve to the next
constexpr double kSamePlace = 2;          // from a point to where a vertex was

param::ParametrizeOptions parametrize_options(const Options& options, bool drawing) {
  param::ParametrizeOptions result = options.parametrize;
  if (!drawing || options.drawn_distance >= result.polyline_distance) return result;
  result.stepped_distance = std::max(result.stepped_distance, result.polyline_distance);
  result.polyline_distance = options.drawn_distance;
  return result;
}

double weak_share(const Options& options, bool drawing) {
  return drawing ? std::max(options.weak_share, options.drawn_weak_share) : options.weak_share;
}

/// By chain, whether its polyline has a segment that is shorter. Where chains turn back by next to nothing,
/// there may be some that only the map would undo.
std::vector<bool> with_shorter_segments(const param::Parametrization& p, std::size_t chains, double least) {
  std::vector<bool> short_ones(chains, false);
  for (const param::Polyline& line : p.polylines) {
    const std::size_t n = line.vertices.size();
    for (std::size_t i = 0; i + 1 < n + (line.closed ? 1 : 0); ++i) {
      const Vec2 from = p.vertices[line.vertices[i]].position;
      const Vec2 to = p.vertices[line.vertices[(i + 1) % n]].position;
      if (norm(to - from) < least) short_ones[line.chain] = true;
    }
  }
  return short_ones;
}

features::FeatureChains detected(const Grid& grid, const Options& options, bool drawing) {
  features::FeatureChains found = features::detect_features(grid.pixels, detect_options(options, drawing));
  if (grid.scale() > 1) features::mark_stepped(grid.original, found);
  if (options.max_turning > 0) drop_winding(options.max_turning, found);
  return found;
}

class Mapping {
 public:
  /// @param scale of the grid; map_curves() needs no more of it than that.
  Mapping(const Grid& grid, int scale, bool drawing, const Options& options, std::size_t max_functions,
          features::KnownCorners& known, RunLog& log, MappedPicture& mapped)
      : picture_(grid.pixels),
        original_(grid.original),
        scale_(scale),
        options_(options),
        drawing_(drawing),
        parametrize_(parametrize_options(options, drawing_)),
        shares_{options.feature_share, weak_share(options, drawing_)},
        max_functions_(max_functions),
        known_(known),
        log_(log),
        mapped_(mapped) {}

  void begin(features::FeatureChains found) {
    mapped_.detected = std::move(found);
    if (!options_.features) return;
    log_.progress.detected = &mapped_.detected;
    log_.show("features");
  }

  void fair_and_spread() {
    fair();
    features::space_points(mapped_.faired, scale_ * kLeastSpace);
  }

  /// Where the pixels are is left open. @return whether the polylines make a sound mesh.
  bool map_curves(const Curves& curves, std::span<const Vec2> vertices) {
    mapped_.detected = curves.detected;
    if (!mapped_.detected.chains.empty() && limit_features(expected_of_chains())) {
      fair_and_spread();
    } else {
      mapped_.faired = curves.faired;
    }
    for (;;) {
      features::prefer_points(mapped_.faired, vertices, scale_ * kSamePlace);
      do {
        if (!find_polylines()) return false;
      } while (mapped_.has_features() && be_coarser(functions_of_knots()));
      if (!mapped_.has_features() || !limit_features(functions_of_knots())) return true;
      fair_and_spread();
    }
  }

  /// Once more whenever features turn out to cost more than they may.
  void map() {
    if (!mapped_.detected.chains.empty()) limit_features(expected_of_chains());
    fair();
    for (;;) {
      if (mapped_.has_features()) {
        const double functions = functions_of_polylines();
        log_.lap("parametrize");
        if (be_coarser(functions)) continue;
        if (limit_features(functions)) {
          fair();
          continue;
        }
        correct_colours();
      }
      parametrize();
      if (!mapped_.has_features() || !limit_features(functions_of_knots())) break;
      fair();
    }
  }

 private:
  void fair() {
    mapped_.faired = mapped_.detected;
    log_.report.corners = 0;
    if (!mapped_.has_features()) return;
    if (options_.fairing) features::fair_chains(mapped_.faired, options_.fair);
    if (options_.corner_detection) {
      log_.report.corners = features::sharpen_corners(original_, mapped_.faired, options_.corners, &known_);
      features::prefer_side_ends(mapped_.faired);
    }
    log_.progress.faired = &mapped_.faired;
    log_.lap("fair");
    log_.show("fairing");
  }

  void correct_colours() {
    mapped_.corrected = options_.colour_correction
                            ? features::correct_colours(picture_, mapped_.faired, options_.correction)
                            : picture_;
    log_.progress.corrected = &mapped_.corrected;
    log_.lap("correct");
    log_.show("correction");
  }

  mesh::KnotMesh mesh_of(const param::Parametrization& parametrization) const {
    return initial_mesh(parametrization, options_.segment_knot_spacing,
                        options_.clear_curves ? scale_ * kShortSegment : 0);
  }

  /// About; 0 if the polylines make no sound mesh. Nearly what it is in the end, and known without the map.
  double functions_of_polylines() const {
    try {
      const mesh::KnotMesh mesh = mesh_of(param::first_polylines(mapped_.faired, parametrize_));
      return expected_functions(EditableMesh(mesh), options_.degree);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument) throw;
      return 0;
    }
  }

  double expected_of_chains() const { return expected_functions(mapped_.detected) / scale_; }

  double functions_of_knots() const {
    return expected_functions(EditableMesh(mapped_.knots), options_.degree);
  }

  /// Without the few chains that would have too short segments. @return whether there is a sound mesh.
  bool find_polylines() {
    do {
      if (!make_polylines()) return false;
    } while (drop_short_ones());
    return true;
  }

  /// @return whether they make a sound mesh, if no segment is too short.
  bool make_polylines() {
    mapped_.parametrization = {};
    if (mapped_.has_features())
      mapped_.parametrization = param::first_polylines(mapped_.faired, parametrize_);
    mapped_.parametrization.width = scale_ * original_.width;
    mapped_.parametrization.height = scale_ * original_.height;
    log_.report.polyline_vertices = mapped_.parametrization.vertices.size();
    try {
      mapped_.knots = mesh_of(mapped_.parametrization);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument) throw;
      return false;
    }
    log_.lap("polylines");
    return true;
  }

  /// One frame without a letter's dot is better than one that is made anew. @return whether any had to go.
  bool drop_short_ones() {
    std::vector<features::Chain>& chains = mapped_.faired.chains;
    const std::vector<bool> short_ones =
        with_shorter_segments(mapped_.parametrization, chains.size(), scale_ * kShortestSegment);
    std::vector<features::Chain> kept;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      if (!short_ones[c]) kept.push_back(std::move(chains[c]));
    }
    std::swap(chains, kept);
    return chains.size() < kept.size();
  }

  /// Goes back from the finer polylines of drawings if features would then use up too much.
  bool be_coarser(double functions) {
    const double allowed =
        std::min(options_.feature_share, kShareOfFine) * static_cast<double>(max_functions_);
    if (parametrize_.polyline_distance >= options_.parametrize.polyline_distance || functions <= allowed)
      return false;
    parametrize_ = options_.parametrize;
    return true;
  }

  /// Drops chains if they cost too many control points. @return whether it did.
  bool limit_features(double functions) {
    const std::size_t before = mapped_.detected.chains.size();
    mapped_.dropped.add(keep_within_budget(original_, functions, static_cast<double>(max_functions_), shares_,
                                           mapped_.detected));
    const std::size_t dropped = before - mapped_.detected.chains.size();
    log_.report.chains_over_budget += dropped;
    return dropped > 0;
  }

  void parametrize() {
    if (!mapped_.has_features()) {
      mapped_.parametrization = {};
      mapped_.parametrization.width = picture_.width;
      mapped_.parametrization.height = picture_.height;
      mapped_.knots = mesh_of(mapped_.parametrization);
      return;
    }
    mapped_.image_mesh = features::make_image_mesh(mapped_.faired);
    log_.progress.image_mesh = &mapped_.image_mesh;
    param::ParametrizeReport report;
    mapped_.parametrization = param::parametrize(mapped_.faired, mapped_.image_mesh, parametrize_, &report);
    log_.report.folds_left = report.folds_left;
    log_.report.polyline_vertices = mapped_.parametrization.vertices.size();
    log_.progress.parametrization = &mapped_.parametrization;
    log_.lap("parametrize");
    log_.show("parametrization");
    try {
      mapped_.knots = mesh_of(mapped_.parametrization);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument || mapped_.parametrization.polylines.empty()) throw;
      drop_features();
    }
  }

  /// Features whose polylines make no sound mesh (never seen) are given up.
  void drop_features() {
    log_.report.features_dropped = true;
    mapped_.faired = {};
    parametrize();
  }

  const image::Image& picture_;
  const image::Image& original_;
  int scale_;  // pixels per pixel of the original, along a row
  const Options& options_;
  bool drawing_;
  param::ParametrizeOptions parametrize_;
  FeatureShares shares_;
  std::size_t max_functions_;
  features::KnownCorners& known_;  // chains are sharpened anew whenever some were dropped
  RunLog& log_;
  MappedPicture& mapped_;
};

}  // namespace

void MappedPicture::forget_pixels() {
  image_mesh = {};
  parametrization.position = std::vector<Vec2>();  // {} would keep the memory
  parametrization.parameter = std::vector<Vec2>();
}

features::FeatureChains find_features(const Grid& grid, const Options& options, RunLog& log) {
  if (!options.features) return {};
  features::FeatureChains found = detected(grid, options, features::is_drawing(grid.original));
  log.report.chains = found.chains.size();
  for (const auto& c : found.chains) log.report.feature_pixels += c.points.size();
  log.lap("detect");
  return found;
}

void map_features(const Grid& grid, const features::FeatureChains& found, const Options& options,
                  std::size_t max_functions, features::KnownCorners& known, RunLog& log,
                  MappedPicture& mapped) {
  const bool drawing = options.features && features::is_drawing(grid.original);
  Mapping mapping(grid, grid.scale(), drawing, options, max_functions, known, log, mapped);
  mapping.begin(found);
  mapping.map();
}

/// Without noise, which thresholds are there for, faint edges are edges, too.
features::DetectOptions detect_options(const Options& options, bool drawing) {
  features::DetectOptions detect = options.detect;
  if (!drawing) return detect;
  if (detect.max_blur > 0) detect.max_blur = std::max(detect.max_blur, options.drawn_blur);
  if (options.drawn_threshold > 0 && options.drawn_threshold < detect.edge_threshold) {
    detect.anchor_threshold *= options.drawn_threshold / detect.edge_threshold;
    detect.edge_threshold = options.drawn_threshold;
  }
  return detect;
}

features::FeatureChains faired_curves(const image::Image& picture, const features::FeatureChains& detected,
                                      const Options& options, features::KnownCorners& known) {
  const Observer nobody;
  RunLog log(picture, nobody);
  log.begin_round("features");
  MappedPicture mapped;
  Mapping mapping({picture, picture}, features::scale_of(detected, picture), true, options, 0, known, log,
                  mapped);
  mapping.begin(detected);
  mapping.fair_and_spread();
  return std::move(mapped.faired);
}

bool map_curves(const image::Image& picture, const Options& options, std::size_t max_functions,
                const Curves& curves, std::span<const Vec2> vertices, features::KnownCorners& known,
                RunLog& log, MappedPicture& mapped) {
  const int scale = features::scale_of(curves.detected, picture);
  return Mapping({picture, picture}, scale, true, options, max_functions, known, log, mapped)
      .map_curves(curves, vertices);
}

knots::Target make_target(const Grid& grid, const MappedPicture& mapped) {
  const image::Image& picture = grid.pixels;
  // Large ones leave all caches anyway: a fine grid of 2560x1440 would need 295 MB, and needs 74.
  using Storage = knots::Target::Storage;
  const bool is_large = grid.scale() > 1 || picture.pixel_count() > kManyPixels;
  const Storage storage = is_large ? Storage::kCompact : Storage::kFast;
  if (!mapped.has_features()) return {picture, fit::steering_weights(picture, {}), storage};
  auto image =
      param::parametrized_image(mapped.corrected, mapped.faired, mapped.image_mesh, mapped.parametrization);
  std::vector<float> weights = fit::steering_weights(image.colours, std::move(image.weights));
  return {std::move(image.colours), std::move(weights), storage};
}

}  // namespace knotreel::vectorize
