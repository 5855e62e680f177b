// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "knotreel/document/frame_model.h"
#include "knotreel/spline/basis.h"

namespace knotreel::raster {

/// Channels of a surface: 0 and 1 are the displacement S_geo(u) - u, then the colours.
inline constexpr std::size_t kGeometryChannels = 2;
inline constexpr std::size_t kMaxChannels = kGeometryChannels + 4;

/// The affine function value + gx (u.x - origin.x) + gy (u.y - origin.y).
struct Plane {
  double value = 0;
  double gx = 0;
  double gy = 0;
};

/// One term of a piece with the control points multiplied in: the surface is the sum over all terms of
/// factor * tent * planes, so that a point needs no look-up of functions.
struct SurfaceTerm {
  spline::Tent tent;
  spline::Affine factor;
  bool has_factor = false;
  bool moves = false;  ///< has a part in the displacement
  Vec2 origin;
  std::array<Plane, kMaxChannels> planes{};
};

/// A model ready for evaluation at points. Immutable, thread safe.
class Surface {
 public:
  explicit Surface(const document::FrameModel& model);
  /// @param basis of the space of the model.
  Surface(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis);

  double width() const { return width_; }
  double height() const { return height_; }
  std::size_t channels() const { return channels_; }  ///< geometry included
  int degree() const { return degree_; }
  const spline::Basis& basis() const { return *basis_; }
  std::span<const SurfaceTerm> terms() const { return terms_; }

  /// Bounds of the displacement over a box of the image: for every u whose image lies in [low, high],
  /// S_geo(u) - u lies in the box returned (the convex hull property of the control points).
  struct Bounds {
    Vec2 low;
    Vec2 high;
    bool zero() const { return low.x == 0 && low.y == 0 && high.x == 0 && high.y == 0; }
  };
  Bounds displacement_bounds(Vec2 low, Vec2 high) const;
  /// The same over the whole image.
  const Bounds& displacement_bounds() const { return overall_; }

  /// Displacement at u and its Jacobian, and colours; one-sided as Basis::evaluate.
  struct Sample {
    Vec2 displacement;
    double jacobian[2][2];
    std::array<double, 4> colour{};
  };
  Sample evaluate(Vec2 u) const;

 private:
  Bounds add_piece(const document::FrameModel& model, const spline::Piece& piece);
  void bound_cells(const spline::Piece& piece, const Bounds& bounds);
  Bounds cell_bounds(Vec2 low, Vec2 high) const;

  double width_;
  double height_;
  std::size_t channels_;
  int degree_;
  std::shared_ptr<const spline::Basis> basis_;
  std::vector<SurfaceTerm> terms_;

  // Displacement bounds of the terms that touch each square cell, and zero.
  double cell_ = 1;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<Bounds> cells_;
  Bounds overall_{};
};

}  // namespace knotreel::raster
