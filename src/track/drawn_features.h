// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "knotreel/features/flat_share.h"
#include "knotreel/image/image.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/spline/basis.h"
#include "knotreel/track/drawn_curves.h"
#include "knotreel/vectorize/options.h"
#include "track/fitted_frame.h"
#include "vectorize/find_curves.h"
#include "vectorize/mapped_picture.h"

namespace knotreel::track {

struct KnownDrawing {
  features::SecondDifferences differences;
  vectorize::KnownCurves curves;  ///< with the picture
};

struct DrawnCurves {
  vectorize::Curves found;  ///< on their grid
  bool fine_grid = false;
  std::shared_ptr<KnownDrawings> known;
};

/// The features of a drawn frame, found in its picture as in a picture on its own, for a mesh whose other
/// knots come from the frame before (docs/decisions/0040).
class DrawnFeatures {
 public:
  /// @param curves find_drawn_curves() of the picture, with these options. @param most_functions control
  /// points of the whole model. @param vertices about where those of the frame before would be: these stay
  /// vertices where they may as well. @param before of the frame before: what it left out is left out for
  /// longer, and what it has stays for longer.
  DrawnFeatures(const image::Image& picture, const vectorize::Options& options, const DrawnCurves& curves,
                std::size_t most_functions, std::span<const Vec2> vertices, const FeatureLimits& before);

  /// Whether they make a mesh; if not, they are of no use.
  bool is_sound() const { return is_sound_; }

  /// The knots of the features, and those of the domain.
  const mesh::KnotMesh& knots() const { return mapped_.knots; }
  const FeatureLimits& limits() const { return limits_; }

  /// The displacements of a space over a mesh with these features: their curves are where they were found.
  /// @param unfold as vectorize::Options. @param step displacements are multiples of it, pixels.
  std::vector<Vec2> displacement(const spline::Basis& basis, double unfold, double step) const;

 private:
  vectorize::MappedPicture mapped_;
  FeatureLimits limits_;
  bool is_sound_ = true;
};

}  // namespace knotreel::track
