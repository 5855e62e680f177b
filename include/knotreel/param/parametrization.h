// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/image_mesh.h"

/// The map between picture and parametric domain (paper sec. 5.2, 5.4). The domain is [0,width] x [0,height]
/// in pixels, and the map is the identity but for a small displacement.
namespace knotreel::param {

/// Where a vertex of a feature polyline lies; on a side of the domain one coordinate is exactly 0, width or
/// height.
enum class VertexPlace : std::uint8_t { kInside, kLeft, kRight, kTop, kBottom };

struct PolylineVertex {
  Vec2 position;  ///< in the parametric domain
  VertexPlace place = VertexPlace::kInside;
};

/// A chain simplified to straight pieces in the parametric domain.
struct Polyline {
  std::uint32_t chain = 0;              ///< index in FeatureChains::chains
  std::vector<std::uint32_t> vertices;  ///< in order of the chain; of a closed one, the first is not repeated
  bool closed = false;
};

/// Pixel of a curve sample that is no pixel: the end of a curve on a side of the domain.
inline constexpr std::int32_t kNoPixel = -1;

/// A point of a feature curve with its place on the polyline.
struct CurveSample {
  std::uint32_t polyline = 0;
  std::uint32_t segment = 0;      ///< from vertices[segment] to the next one
  double t = 0;                   ///< in [0, 1] along the segment; grows along the chain
  Vec2 position;                  ///< in image coordinates
  std::int32_t pixel = kNoPixel;  ///< y * width + x, or kNoPixel
};

struct Parametrization {
  int width = 0;
  int height = 0;
  std::vector<PolylineVertex> vertices;  ///< those of nodes are shared between polylines
  std::vector<Polyline> polylines;
  /// Of all points of all chains (with the pixels and the point on the side that continue them to the
  /// border), in order. A vertex is the start of a segment, t = 0; only the last one of an open polyline has
  /// t = 1.
  std::vector<CurveSample> curve_samples;

  /// Of each pixel: its faired position in the image, and where that is in the parametric domain. Feature
  /// pixels lie on their curve and on their polyline.
  std::vector<Vec2> position;
  std::vector<Vec2> parameter;
};

struct ParametrizeOptions {
  /// eps_d, in pixels, > 0: curves stay this close to their polylines (paper sec. 5.4).
  double polyline_distance = 3;
  /// In place of it, if that is smaller, for chains that are stepped, >= 0: what is known to half a pixel
  /// only is not followed more closely.
  double stepped_distance = 0;
  /// Pieces longer than a few pixels bulge at most by this share of their length, > 0: tight bends and small
  /// circles get the vertices that keep the map free of folds. Bulges under one pixel are always allowed.
  double polyline_bulge = 0.15;
  /// Displacements die off over about this many pixels away from features; 0: they are harmonic (plain
  /// Tutte).
  double decay = 16;
  /// Largest error of the displacements against the exact solution, about, in pixels, > 0.
  double tolerance = 1e-3;
};

/// What parametrize() met. Triangles are those of the image mesh and of the ring between it and the border.
struct ParametrizeReport {
  int dropped_chains = 0;  ///< chains that touch others even as chains of pixels
  int relaxed_points = 0;  ///< curve points moved towards their pixel centres, against crossings and folds
  int folds_found = 0;     ///< triangles turned over by the first solution, in either layout
  int folds_left = 0;      ///< always 0 for chains that keep what FeatureChains promises
  int rounds = 0;          ///< solutions computed
  int cycles = 0;          ///< multigrid cycles of all rounds
};

/// Places the chains on polylines that neither cross nor touch but at common vertices, and displaces all
/// other pixels smoothly so that no triangle of the image mesh turns over (paper sec. 5.2 and 5.4; screened
/// Tutte displacement, docs/decisions/0009). Off the features, displacements under 1/64 px are exactly zero.
/// The same bits for any number of threads; can be called from several threads at once.
/// @throws Error{kInvalidArgument} if the sizes of chains, mesh and options make no sense, a chain leaves the
/// picture or has steps longer than one pixel, or two chains share a pixel that is no node.
Parametrization parametrize(const features::FeatureChains& chains, const features::ImageMesh& mesh,
                            const ParametrizeOptions& options = {}, ParametrizeReport* report = nullptr);

/// The polylines that parametrize() begins with, and the samples on them, without the pixels: a small part of
/// the work. In the end there may be more vertices, where the map would have folded.
/// @throws Error{kInvalidArgument} as parametrize().
Parametrization first_polylines(const features::FeatureChains& chains,
                                const ParametrizeOptions& options = {});

}  // namespace knotreel::param
