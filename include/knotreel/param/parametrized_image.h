// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/image_mesh.h"
#include "knotreel/image/image.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::param {

/// The picture as a function of the parametric domain (phi(u) of paper sec. 6.1), on its pixel grid.
struct ParametrizedImage {
  image::Image colours;        ///< same size and channels as the picture
  std::vector<float> weights;  ///< per pixel: 0 where a feature polyline crosses its square, else 1
};

/// Resamples a picture on the pixel grid of the parametric domain without mixing the two sides of a feature:
/// each triangle of the image mesh is drawn at its parameters, with the colours of its vertices off the
/// features. Between the outermost pixel centres and the border the outermost colours go on. Pixels of weight
/// 0 hold a colour from near by. Far from features, where displacements are zero, samples are copied.
/// @param corrected  the picture, best with corrected colours near features (paper sec. 5.3)
/// @throws Error{kInvalidArgument} if the sizes differ.
ParametrizedImage parametrized_image(const image::Image& corrected, const features::FeatureChains& chains,
                                     const features::ImageMesh& mesh, const Parametrization& parametrization);

}  // namespace knotreel::param
