// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/fine_grid.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "knotreel/base/parallel.h"

namespace knotreel::vectorize {

namespace {

mesh::KnotMesh halved(mesh::KnotMesh mesh) {
  mesh.width *= 0.5;
  mesh.height *= 0.5;
  for (mesh::Knot& knot : mesh.knots) knot.position = 0.5 * knot.position;
  return mesh;
}

/// The pixels' displacements are means of four.
void halve_pixels(const param::Parametrization& fine, param::Parametrization& half) {
  const auto width = static_cast<std::size_t>(half.width);
  half.position.resize(width * static_cast<std::size_t>(half.height));
  half.parameter.resize(half.position.size());
  parallel_for(static_cast<std::size_t>(half.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      Vec2 sum;
      for (const std::size_t row : {2 * y, 2 * y + 1}) {
        for (const std::size_t column : {2 * x, 2 * x + 1}) {
          const std::size_t i = row * 2 * width + column;
          sum = sum + (fine.parameter[i] - fine.position[i]);
        }
      }
      const Vec2 centre{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
      half.position[y * width + x] = centre;
      half.parameter[y * width + x] = centre + 0.125 * sum;
    }
  });
}

MappedPicture halved(const MappedPicture& fine, const image::Image& picture) {
  MappedPicture half = halved_features(fine);
  if (!fine.has_features()) return half;
  half.corrected = picture;
  halve_pixels(fine.parametrization, half.parametrization);
  return half;
}

}  // namespace

bool wants_fine_grid(const image::Image& picture, const Options& options) {
  if (options.fine_grid == FineGrid::kNone || !options.features ||
      picture.pixel_count() > kMostFineGridPixels)
    return false;
  if (options.fine_grid == FineGrid::kDrawings && !features::is_drawing(picture)) return false;
  return !features::detect_features(picture, options.detect).chains.empty();
}

Options suited_to(const image::Image& picture, Options options) {
  if (options.longest_edge == 0 && options.noisy_smoothing == 0) return options;
  return suited_to(picture, features::SecondDifferences(picture), std::move(options));
}

Options suited_to(const image::Image& picture, const features::SecondDifferences& differences,
                  Options options) {
  if (options.longest_edge > 0 && !features::is_drawing(picture, differences)) options.longest_edge = 0;
  if (options.noisy_smoothing == 0 || features::is_clean(differences)) return options;
  options.fine_smoothing = options.noisy_smoothing;
  options.drawn_threshold = 0;
  return options;
}

/// Three stay those of the finer pixels, since drawings lose 0.1 dB and more otherwise: what block_error
/// allows faces of the first mesh, which have a quarter of the area here, so that more of them are split;
/// fair.max_shift_of_steps; and parametrize.decay.
Options on_fine_grid(Options options) {
  constexpr double kScale = 2;
  options.meg *= kScale;
  options.max_turning /= kScale;
  options.detect.edge_threshold /= kScale;
  options.detect.anchor_threshold /= kScale;
  options.detect.min_length *= kScale;
  options.detect.max_blur *= kScale;
  options.drawn_blur *= kScale;
  options.drawn_threshold /= kScale;
  // Thin strokes are features like others here, and cost less than what would stand in for them.
  options.drawn_weak_share = std::max(options.drawn_weak_share, options.feature_share);
  options.detect.smoothing *= options.fine_smoothing;
  options.fair.max_shift *= kScale;
  // Enlarged edges are some pixels wide: what is beside them has the colours of their sides.
  options.correction.strength = 1;
  options.correction.clean_only = true;
  options.parametrize.polyline_distance *= kScale;
  options.drawn_distance *= kScale;
  options.segment_knot_spacing *= kScale;
  options.longest_edge *= kScale;
  options.optimise.min_distance *= kScale;
  return options;
}

Halved::Halved(const MappedPicture& fine, const image::Image& picture)
    : mapped_(halved(fine, picture)), samples_(picture, mapped_, false) {}

/// Chains and samples of curves keep their pixels, which name them; all places are halved.
MappedPicture halved_features(const MappedPicture& fine) {
  MappedPicture half;
  half.knots = halved(fine.knots);
  half.dropped = fine.dropped;
  half.parametrization.width = fine.parametrization.width / 2;
  half.parametrization.height = fine.parametrization.height / 2;
  if (!fine.has_features()) return half;
  half.faired = fine.faired;
  for (features::Chain& chain : half.faired.chains) {
    for (features::ChainPoint& p : chain.points) {
      p.position = 0.5 * p.position;
      p.beyond = 0.5 * p.beyond;
    }
  }
  half.parametrization.vertices = fine.parametrization.vertices;
  for (param::PolylineVertex& v : half.parametrization.vertices) v.position = 0.5 * v.position;
  half.parametrization.polylines = fine.parametrization.polylines;
  half.parametrization.curve_samples = fine.parametrization.curve_samples;
  for (param::CurveSample& s : half.parametrization.curve_samples) s.position = 0.5 * s.position;
  return half;
}

Draft halved(const Draft& fine) {
  Draft half;
  const spline::SplineSpace& space = *fine.surface.space;
  half.surface.space = std::make_shared<const spline::SplineSpace>(
      spline::SplineSpace::from_link_codes(halved(space.mesh()), space.degree(), space.link_codes()));
  half.surface.fit.control = fine.surface.fit.control;
  half.displacement.assign(half.surface.space->geometry_count(), Vec2{});
  return half;
}

std::vector<float> on_fine_pixels(const std::vector<float>& values, int width) {
  const auto columns = static_cast<std::size_t>(width);
  std::vector<float> fine(4 * values.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const std::size_t x = i % (2 * columns), y = i / (2 * columns);
    fine[i] = values[y / 2 * columns + x / 2];
  }
  return fine;
}

}  // namespace knotreel::vectorize
