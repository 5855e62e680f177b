// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "knotreel/base/happens_before.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"
#include "knotreel/pipeline/job.h"
#include "knotreel/spline/pixel_surface.h"
#include "knotreel/track/tracker.h"

namespace knotreel::pipeline {

struct Stretch;

/// A frame on its way through the stages; each fills in its part.
struct Message {
  std::uint64_t index = 0;
  video::Frame frame;  ///< its image is in `picture`
  std::shared_ptr<const image::Image> picture;
  std::shared_ptr<const image::Image> before;  ///< null for the first frame
  std::unique_ptr<track::Motion> motion;
  bool same_picture = false;  ///< as the frame before has, bit for bit
  bool repeats = false;       ///< picture and stored model are those of the frame before: so is what is drawn
  std::shared_ptr<Stretch> stretch;                     ///< that it belongs to; until it has a model
  bool starts_group = false;                            ///< for certain or nearly so; drift is not foreseen
  track::MadeAhead ahead;                               ///< until it has a model
  document::FrameModel model;                           ///< from the stage "documents" on: as stored
  std::shared_ptr<const spline::PixelSurface> surface;  ///< of the model, if it is known
  /// Tiles of the model in which it may look other than the one before, as Tracker::changed_tiles(); none:
  /// all.
  std::vector<std::uint8_t> changed;
  document::FrameModel next;  ///< the frame after, if `model` is to be taken on the way to it ...
  double share = 0;           ///< ... by so much
  image::Image rendering;     ///< of the size of the output; in the tiles that changed
  image::Image beside;        ///< what Job::compose made
  FrameRow row;
  HappensBefore passed_on;  ///< by the stage before
};

/// Messages are moved from stage to stage by the graph, which copies.
using MessagePtr = std::shared_ptr<Message>;

}  // namespace knotreel::pipeline
