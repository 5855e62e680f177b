// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/batch/picture_job.h"
#include "cli/video_run.h"

namespace knotreel::cli::batch {

/// A clip to a document with all frames, as `knotreel vectorize` makes it, or to a video, as `knotreel
/// transcode` does.
class ClipJob : public Job {
 public:
  /// @param run  how; input and outputs are those of the items. @param alone_above  pixels of the frames in
  /// flight above which a clip is in the room alone.
  ClipJob(VideoRun run, bool transcode, double alone_above)
      : run_(std::move(run)), transcode_(transcode), alone_above_(alone_above) {}
  Figures run(const Item& item, Room& room) const override;

 private:
  VideoRun run_;
  bool transcode_;
  double alone_above_;
};

/// Pictures and clips to documents, each by its own job; or everything to videos.
class AnyJob : public Job {
 public:
  AnyJob(const PictureJob& pictures, const ClipJob& clips, bool transcode)
      : pictures_(pictures), clips_(clips), transcode_(transcode) {}
  Figures run(const Item& item, Room& room) const override;

 private:
  const PictureJob& pictures_;
  const ClipJob& clips_;
  bool transcode_;
};

}  // namespace knotreel::cli::batch
