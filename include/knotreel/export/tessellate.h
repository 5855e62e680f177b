// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "knotreel/document/frame_model.h"

/// Vector models for other programs: triangles, PDF and SVG (docs/export.md).
namespace knotreel::exporting {

/// How closely triangles with linear colours follow a surface. Both errors are measured along the edges and
/// in the middle of the triangles while they are made, so they are targets rather than proven bounds; tests
/// sample the result densely and find them kept.
struct TessellationOptions {
  double colour_tolerance = 2;      ///< largest error of a channel, in levels of 0..255; 0.01 to 255
  double geometry_tolerance = 0.1;  ///< largest distance of positions in pixels; 0.001 to 100
};

/// @throws Error{kInvalidArgument} for tolerances out of range.
void check_tolerances(const TessellationOptions& options);

/// A point of the surface, seen from one side of the features.
struct SurfacePoint {
  Vec2 u;                          ///< parameter, in pixels
  Vec2 x;                          ///< S_geo(u), in pixels of the picture
  std::array<double, 4> colour{};  ///< S_col(u), clamped to 0..255; as many as the model has channels
};

/// Triangles in positive order over common vertices.
struct Patch {
  std::vector<SurfacePoint> vertices;
  /// Barycentric coordinates of the vertices in the face, exact on its edges; empty for what is no face.
  std::vector<std::array<double, 3>> weights;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

class Sheets;

/// Cuts the faces of a knot mesh into triangles small enough for linear interpolation. Immutable, thread
/// safe. The model must outlive it.
///
/// Whether an edge is halved depends on nothing but the edge (for one on a feature: on both its sides), so
/// the patches of two faces fit without a gap or a T-junction, whoever makes them: patches can be streamed.
class Tessellator {
 public:
  /// @throws Error{kInvalidArgument} for tolerances out of range.
  explicit Tessellator(const document::FrameModel& model, const TessellationOptions& options = {});
  ~Tessellator();

  /// Faces of the cut mesh.
  std::size_t face_count() const;

  /// The surface over one face of the cut mesh. Equal bits whenever it is called. @pre face < face_count().
  /// @param spend  called with numbers of triangles as they are made; may throw to stop, since a face of a
  /// wild surface may become many millions.
  Patch face(std::size_t face, const std::function<void(std::size_t)>& spend = {}) const;

  /// Where half edge `3 * face + i` (from corner i of the face to the next) is divided: ascending, the first
  /// 0 and the last 1.
  std::vector<double> edge_parameters(std::uint32_t half_edge) const;

  /// Walls and one-sided points; for the other files of the module.
  const Sheets& sheets() const { return *sheets_; }

 private:
  friend class FaceRefiner;

  double error(const SurfacePoint& point, const SurfacePoint& wanted) const;
  void divide_feature(std::uint32_t half_edge);

  TessellationOptions options_;
  std::unique_ptr<const Sheets> sheets_;
  std::vector<std::vector<double>> feature_parameters_;  ///< by half edge; empty off the features
};

}  // namespace knotreel::exporting
