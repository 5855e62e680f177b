// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/image_mesh.h"
#include "knotreel/image/image.h"
#include "knotreel/param/parametrization.h"
#include "knotreel/vectorize/options.h"

/// The image pipeline: one picture to one vector model (paper sec. 5 to 8).
namespace knotreel::vectorize {

/// Figures of one round of fitting; those of colours are of the fit, before quantisation and without the
/// pixels that features cross.
struct RoundReport {
  std::string name;  ///< "round 1", ..., "descent", "final"
  std::size_t knots = 0;
  std::size_t control_points = 0;
  double mec = 0;   ///< levels
  double meg = 0;   ///< pixels; of the last geometry that was fitted, 0 before: further rounds ask for one
  double psnr = 0;  ///< dB
  std::size_t raw_bytes = 0;
  std::vector<std::pair<std::string, double>> milliseconds;  ///< per stage, in order
};

struct Report {
  std::size_t max_control_points = 0;  ///< the bound in the end, which may have grown for features
  std::size_t chains = 0;
  std::size_t chains_over_budget =
      0;                            ///< of these, dropped because features may not use up the control points
  bool strong_over_budget = false;  ///< not only weak ones were dropped so
  double feature_share = 0;         ///< of the control points, that features could use up; above 1: no limit
  std::size_t feature_pixels = 0;
  std::size_t corners = 0;  ///< sharp ones of features, and where several meet
  std::size_t polyline_vertices = 0;
  int folds_left = 0;              ///< of the parametrization
  std::size_t geometry_folds = 0;  ///< samples beside features where the surface still folds over
  bool fine_grid = false;          ///< as Options::fine_grid; chains and pixels are of that grid then
  bool features_dropped = false;   ///< their polylines made no sound knot mesh, or none that can be stored
  std::vector<RoundReport> rounds;
};

/// What there is to see after a stage; pointers are null before their stage, and valid during the call only.
/// From the first knots on there are no image mesh and parametrization any more.
/// On a fine grid (Options::fine_grid) all but the last round is at twice the size, the picture too, and
/// nothing of it is left in "final".
struct Progress {
  std::string stage;  ///< "features", "fairing", "correction", "parametrization", "knots", then as
                      ///< RoundReport::name; "descent step"
  const image::Image* picture = nullptr;
  const features::FeatureChains* detected = nullptr;
  const features::FeatureChains* faired = nullptr;
  const image::Image* corrected = nullptr;
  const features::ImageMesh* image_mesh = nullptr;
  const param::Parametrization* parametrization = nullptr;
  const mesh::KnotMesh* knot_mesh = nullptr;
  const document::FrameModel* model = nullptr;
  const std::vector<float>* residual = nullptr;  ///< as fit::ColourFit; see Options::half_rows
};

/// Called between stages, on the thread of the caller; may throw to stop the work.
using Observer = std::function<void(const Progress&)>;

/// The model as it was fitted at the end, for who goes on from there.
struct Fitted {
  std::shared_ptr<const spline::Basis> basis;  ///< of the space of the model
  std::vector<Vec2> places;                    ///< of the pixels in the domain; empty: the centres
  std::vector<std::uint8_t> crossed;           ///< 1 for pixels that features cross; empty: none
};

struct Vectorization {
  document::FrameModel model;
  Report report;
  Fitted fitted;
};

/// Largest sample that a picture may have, in magnitude: 10,000 times white. Documents hold control colours
/// up to six times that.
inline constexpr float kLargestSample = 2'550'000;

/// Vectorizes a picture of any size with 1 to 4 channels. Deterministic: the same for any number of threads.
/// Memory: about 600 bytes per pixel for a picture of half a megapixel, 320 for one of 25 (8 GB), 1400 on a
/// fine grid.
/// @throws Error{kInvalidArgument} for an empty picture, samples that are not finite or beyond
/// kLargestSample, or options out of range.
Vectorization vectorize_picture(const image::Image& picture, const Options& options = {},
                                const Observer& observer = {});

}  // namespace knotreel::vectorize
