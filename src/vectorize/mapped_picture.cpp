#include "vectorize/mapped_picture.h"

#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/param/parametrized_image.h"
#include "vectorize/feature_budget.h"
#include "vectorize/initial_mesh.h"

namespace knotreel::vectorize {

namespace {

using mesh::EditableMesh;

// Pixels. Antialiased drawings have 1.11 to 1.25, sharpened photographs from 1.31 on.
constexpr double kDrawnEdgeWidth = 1.3;

class Mapping {
 public:
  Mapping(const image::Image& picture, const Options& options, std::size_t max_functions, RunLog& log,
          MappedPicture& mapped)
      : picture_(picture), options_(options), max_functions_(max_functions), log_(log), mapped_(mapped) {}

  void find() {
    if (!options_.features) return;
    features::DetectOptions detect = options_.detect;
    if (detect.max_blur < options_.drawn_blur &&
        features::mean_edge_width(picture_, detect) < kDrawnEdgeWidth) {
      detect.max_blur = options_.drawn_blur;
    }
    mapped_.detected = features::detect_features(picture_, detect);
    log_.progress.detected = &mapped_.detected;
    log_.report.chains = mapped_.detected.chains.size();
    for (const auto& c : mapped_.detected.chains) log_.report.feature_pixels += c.points.size();
    log_.lap("detect");
    log_.show("features");
  }

  /// Once more whenever features turn out to cost more than they may.
  void map() {
    if (!mapped_.detected.chains.empty()) limit_features(expected_functions(mapped_.detected));
    for (;;) {
      fair();
      if (mapped_.has_features()) {
        const double functions = functions_of_polylines();
        log_.lap("parametrize");
        if (limit_features(functions)) continue;
        correct_colours();
      }
      parametrize();
      if (!mapped_.has_features() ||
          !limit_features(expected_functions(EditableMesh(mapped_.knots), options_.degree)))
        break;
    }
  }

 private:
  void fair() {
    mapped_.faired = mapped_.detected;
    if (!mapped_.has_features()) return;
    if (options_.fairing) features::fair_chains(mapped_.faired, options_.fair);
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

  /// About; 0 if the polylines make no sound mesh. Nearly what it is in the end, and known without the map.
  double functions_of_polylines() const {
    try {
      const mesh::KnotMesh mesh = initial_mesh(param::first_polylines(mapped_.faired, options_.parametrize),
                                               options_.segment_knot_spacing);
      return expected_functions(EditableMesh(mesh), options_.degree);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInvalidArgument) throw;
      return 0;
    }
  }

  /// Drops chains if they cost too many control points. @return whether it did.
  bool limit_features(double functions) {
    const std::size_t before = mapped_.detected.chains.size();
    keep_within_budget(picture_, functions, static_cast<double>(max_functions_), options_.feature_share,
                       mapped_.detected);
    const std::size_t dropped = before - mapped_.detected.chains.size();
    log_.report.chains_over_budget += dropped;
    return dropped > 0;
  }

  void parametrize() {
    if (!mapped_.has_features()) {
      mapped_.parametrization = {};
      mapped_.parametrization.width = picture_.width;
      mapped_.parametrization.height = picture_.height;
      mapped_.knots = initial_mesh(mapped_.parametrization, options_.segment_knot_spacing);
      return;
    }
    mapped_.image_mesh = features::make_image_mesh(mapped_.faired);
    log_.progress.image_mesh = &mapped_.image_mesh;
    param::ParametrizeReport report;
    mapped_.parametrization =
        param::parametrize(mapped_.faired, mapped_.image_mesh, options_.parametrize, &report);
    log_.report.folds_left = report.folds_left;
    log_.report.polyline_vertices = mapped_.parametrization.vertices.size();
    log_.progress.parametrization = &mapped_.parametrization;
    log_.lap("parametrize");
    log_.show("parametrization");
    try {
      mapped_.knots = initial_mesh(mapped_.parametrization, options_.segment_knot_spacing);
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
  const Options& options_;
  std::size_t max_functions_;
  RunLog& log_;
  MappedPicture& mapped_;
};

}  // namespace

void map_features(const image::Image& picture, const Options& options, std::size_t max_functions, RunLog& log,
                  MappedPicture& mapped) {
  Mapping mapping(picture, options, max_functions, log, mapped);
  mapping.find();
  mapping.map();
}

knots::Target make_target(const image::Image& picture, const MappedPicture& mapped) {
  if (!mapped.has_features()) return {picture, {}};
  auto image =
      param::parametrized_image(mapped.corrected, mapped.faired, mapped.image_mesh, mapped.parametrization);
  return {std::move(image.colours), std::move(image.weights)};
}

}  // namespace knotreel::vectorize
