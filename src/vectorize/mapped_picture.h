// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "knotreel/features/chains.h"
#include "knotreel/features/image_mesh.h"
#include "knotreel/features/known_corners.h"
#include "knotreel/image/image.h"
#include "knotreel/knots/target.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/param/parametrization.h"
#include "vectorize/feature_budget.h"
#include "vectorize/run_log.h"

namespace knotreel::vectorize {

/// A picture with its features (paper sec. 5), and where they lie in the domain.
struct MappedPicture {
  features::FeatureChains detected;  ///< within their budget
  features::FeatureChains faired;
  image::Image corrected;          ///< without the mixed colours beside features; empty without features
  features::ImageMesh image_mesh;  ///< empty without features
  param::Parametrization parametrization;
  mesh::KnotMesh knots;  ///< that features ask for
  DroppedFeatures dropped;

  bool has_features() const { return !faired.chains.empty(); }
  /// Lets go of where the pixels lie, once there are Samples: 32 bytes per pixel.
  void forget_pixels();
};

/// A picture to find features in, and the one that was given: the same, or it is that one enlarged twofold.
struct Grid {
  const image::Image& pixels;
  const image::Image& original;

  int scale() const { return &pixels == &original ? 1 : 2; }
};

/// All features of a picture. @param options in pixels of the grid, as also for map_features().
features::FeatureChains find_features(const Grid& grid, const Options& options, RunLog& log);

/// Straightens as many features as their share of the control points allows, and maps the picture.
/// @param found         find_features(), with the same options but for shares.
/// @param max_functions control points of the whole model.
/// @param known         of the same picture, or empty.
/// @param mapped        made; the log's progress points into it.
void map_features(const Grid& grid, const features::FeatureChains& found, const Options& options,
                  std::size_t max_functions, features::KnownCorners& known, RunLog& log,
                  MappedPicture& mapped);

/// All features of a drawing, whether there is room for them or not.
struct Curves {
  features::FeatureChains detected;
  features::FeatureChains faired;  ///< and spread (features::space_points)
};

/// Those of the detection, in pixels as these are.
features::DetectOptions detect_options(const Options& options, bool drawing);

/// Makes the features of a drawing fair, gives them corners and spreads their points. What comes of a feature
/// does not hang on others, but for those that share its nodes.
/// @param picture the original.
/// @param known of the pictures before, as also for map_curves().
features::FeatureChains faired_curves(const image::Image& picture, const features::FeatureChains& detected,
                                      const Options& options, features::KnownCorners& known);

/// The same as map_features() without the pixels, which is a part of the work: neither the corrected picture
/// nor the image mesh is made, and the map has no pixels.
/// @param picture  the original.
/// @param curves   find_curves() of its grid, with the same options but for shares.
/// @param vertices where polylines had vertices in the picture before, which may as well stay; on the grid.
/// @return whether the knots are those of a sound mesh; if not, what is mapped is of no use.
bool map_curves(const image::Image& picture, const Options& options, std::size_t max_functions,
                const Curves& curves, std::span<const Vec2> vertices, features::KnownCorners& known,
                RunLog& log, MappedPicture& mapped);

/// The picture over the domain, where knots are placed. @param grid as it was mapped.
knots::Target make_target(const Grid& grid, const MappedPicture& mapped);

}  // namespace knotreel::vectorize
