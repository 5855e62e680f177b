// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/image_mesh.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::param::testing {

/// Everything that must hold for any chains; failures are reported through GoogleTest. Written without the
/// code of the module: planarity is tested pair by pair, in quadruple precision.
void expect_sound(const features::FeatureChains& chains, const features::ImageMesh& mesh,
                  const Parametrization& p);

/// Parametrizes with the default options and checks all of that, and that no chain is lost.
Parametrization run_sound(const features::FeatureChains& chains, ParametrizeReport* report = nullptr);

/// Smallest signed area of a triangle of the image mesh with a vertex off the features, at rest 0.5.
double smallest_area(const features::ImageMesh& mesh, const Parametrization& p,
                     const std::vector<Vec2>& layout);

}  // namespace knotreel::param::testing
