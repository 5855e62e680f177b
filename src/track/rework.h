// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/motion/unchanged.h"
#include "knotreel/track/tracker.h"
#include "track/fitted_frame.h"
#include "track/laps.h"
#include "track/settle.h"

namespace knotreel::track {

/// What the mesh of a frame is reworked by.
struct ReworkInput {
  const FittedFrame& frame;
  const mesh::KnotMesh& mesh;      ///< of the frame, with the knots where they are before they are rounded
  const knots::Target& target;     ///< of the picture as it came
  const motion::Rest& rest;        ///< of the video, as of this picture
  std::size_t most_functions = 0;  ///< of any frame
  bool is_drawn = false;           ///< its features are found anew in each frame
  bool is_missed = false;          ///< it is above the error that is good enough, or something is left out
};

/// What a rework counts and hands out.
struct ReworkLog {
  MeshChanges& changes;
  Laps& laps;
  std::uint32_t& next_id;  ///< of knots
};

/// Leaves the mesh that the next frame starts from: once in a while, and where the fit has fallen, knots go a
/// step against the gradient of the error, features that the model lacks are added, and knots that are lost
/// or idle come back where the error is.
class Rework {
 public:
  Rework(const vectorize::Options& cold, const TrackOptions& options)
      : cold_(cold), options_(options), settling_(SettleOptions{}) {}

  /// @param frame the first of the group.
  void start_group(const FittedFrame& frame);

  /// The mesh for the next frame; the frame is done with. @param mec of the frame, levels. @param urgent the
  /// error has risen.
  mesh::KnotMesh for_next_frame(const ReworkInput& input, double mec, bool urgent, const ReworkLog& log);

  /// The mesh for the same frame, which is to be fitted again because the error has risen.
  mesh::KnotMesh at_once(const ReworkInput& input, const ReworkLog& log) { return rework(input, true, log); }

  /// Whether features were added since this was asked last: they were never bent to their edges.
  bool take_new_features();

 private:
  mesh::KnotMesh rework(const ReworkInput& input, bool urgent, const ReworkLog& log);
  void settle(const ReworkInput& input, std::span<const float> errors, bool urgent, mesh::KnotMesh& mesh);
  std::vector<mesh::KnotIndex> add_features(const ReworkInput& input, std::span<const float> errors,
                                            mesh::EditableMesh& mesh, const ReworkLog& log);
  void refill(const ReworkInput& input, std::span<const float> errors, bool urgent, mesh::EditableMesh& mesh,
              const std::vector<mesh::KnotIndex>& born, double born_functions, const ReworkLog& log) const;
  void grow_group(const ReworkInput& input);
  double richer(const FittedFrame& frame) const;

  vectorize::Options cold_;
  TrackOptions options_;
  Settling settling_;
  bool is_dense_ = false;            ///< the group: FittedFrame::dense
  std::size_t first_functions_ = 0;  ///< of the group
  std::size_t group_functions_ = 0;
  double group_features_ = 0;  ///< length of the feature polylines at its start, pixels
  int since_births_ = 0;       ///< frames
  int since_rework_ = 0;       ///< frames
  bool has_new_features_ = false;
};

}  // namespace knotreel::track
