// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

/// A point of a feature curve: where it is in the parametric domain and in the image.
struct CurvePoint {
  Vec2 parameter;
  Vec2 position;
  bool joint = false;  ///< two segments meet here, and are one smooth curve
};

struct GeometryFitOptions {
  /// Of points on features; pixels have 1. More than in the paper (sec. 7.2), where curves give way to the
  /// pixels beside them and come out angular.
  double feature_weight = 200;
  /// Of each joint, as many times that of a point: its two segments go on into each other, which the paper
  /// does not ask for. 0: it is left to the points.
  double joint_weight = 2;
  double ridge = 1e-5;      ///< as in ColourFitOptions: towards no displacement
  double least = 1.0 / 64;  ///< displacements shorter than this are set to zero, pixels
};

/// Least-squares fit of the geometry part (paper sec. 7.2, Eq. 12): the surface takes the place of each pixel
/// to the centre of the pixel, and the points of the feature curves to theirs. Functions that are one
/// function cut at a feature share their control point. In place of a large weight on the border, its control
/// points stay exactly there. Control points that no displaced pixel touches stay at their Greville sites
/// without being solved for.
/// @param values of the basis functions at `places`.
/// @param places of the pixels, row-major; empty: the centres, and nothing is displaced.
/// @return displacements of the control points from their Greville sites, by geometry group, in pixels.
std::vector<Vec2> fit_geometry(const spline::PixelValues& values, std::span<const Vec2> places,
                               std::span<const CurvePoint> curves, const GeometryFitOptions& options = {});

/// Distances between the points of the feature curves and the surface there, in pixels; their mean is the
/// MEG.
std::vector<double> geometry_errors(const spline::Basis& basis, std::span<const Vec2> displacement,
                                    std::span<const CurvePoint> curves);

/// Shrinks displacements where the map would fold over, which a least-squares fit does not prevent: at
/// samples on both sides of all features its area must stay above a twentieth.
/// @param shrink  factor of displacements at folds, each time: nearer to 1 takes longer and no more than it
/// has to.
/// @return the number of samples where that failed.
std::size_t unfold_geometry(const spline::Basis& basis, std::vector<Vec2>& displacement,
                            double shrink = 0.95);

/// Where the geometry takes points of the parametric domain.
std::vector<Vec2> image_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                               std::vector<Vec2> points);

/// @return by pixel, 1 where a feature curve passes through its square; about: curves are polylines with a
/// vertex per pixel here, and looked at every fifth of a pixel.
std::vector<std::uint8_t> crossed_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                                         int width, int height);

}  // namespace knotreel::fit
