#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// What the geometry part is fitted to: points of the parametric domain and where they are in the image.
struct GeometrySamples {
  int width = 0;  ///< of the pixel grid that the samples belong to
  int height = 0;
  std::span<const Vec2> parameter;           ///< one per pixel, row-major
  std::span<const Vec2> position;            ///< in the image, one per pixel
  std::span<const std::uint8_t> on_feature;  ///< one per pixel: 1 on a feature curve
};

struct GeometryFitOptions {
  double feature_weight = 20;  ///< of samples on features; others have 1 (paper sec. 7.2)
  double ridge = 1e-5;         ///< as in ColourFitOptions: towards no displacement
  double least = 1.0 / 64;     ///< displacements shorter than this are set to zero, pixels
};

/// Least-squares fit of the geometry part (paper sec. 7.2, Eq. 12): functions that are one function cut at a
/// feature share their control point. In place of a large weight on the border, its control points stay
/// exactly there.
/// @return displacements of the control points from their Greville sites, by geometry group, in pixels.
std::vector<Vec2> fit_geometry(const spline::Basis& basis, const GeometrySamples& samples,
                               const GeometryFitOptions& options = {});

/// The geometry part of a surface turned round: where each pixel centre lies in the parametric domain.
struct PixelPlaces {
  std::vector<Vec2> places;           ///< row-major; exactly the centre where the geometry is the identity
  std::vector<std::uint8_t> crossed;  ///< 1 where a feature curve passes through the square of the pixel
};

/// @param start places to start from (see Pixels), or none. Newton's method; a pixel for which it fails keeps
/// its start.
PixelPlaces invert_geometry(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                            int height, std::span<const Vec2> start);

}  // namespace knotreel::fit
