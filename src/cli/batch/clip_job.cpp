// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/clip_job.h"

#include <cmath>
#include <filesystem>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "knotreel/pipeline/run.h"

namespace knotreel::cli::batch {
namespace {

/// With one thread, the fewest there may be.
constexpr double kLeastFramesInFlight = 4;

}  // namespace

Figures ClipJob::run(const Item& item, Room& room) const {
  check_interrupted();
  VideoRun run = run_;
  run.input = item.input;
  (transcode_ ? run.video.path : run.document) = item.output;
  run.reading.no_copy_streams = !transcode_;
  make_folder_of(item.output);
  video::VideoReader reader = video::VideoReader::open(item.input, read_options(run.reading, run.threads));
  const double pixels = double(reader.info().width) * double(reader.info().height);
  const Room::Stay stay = room.enter(kLeastFramesInFlight * pixels > alone_above_);
  pipeline::Job job = make_job(run, reader);
  // Given up rather than cut short: a part of a clip is not what was asked for.
  job.stop = {};
  job.on_frame = [](const pipeline::FrameRow&) { check_interrupted(); };
  const pipeline::Summary summary = pipeline::run_graph(job);
  warn_of(item.input, reader.warnings());
  warn_of(item.input, summary.warnings);
  warn_of(item.input, missing_frames(run, summary));
  return {static_cast<std::size_t>(std::lround(summary.knots)),
          static_cast<std::size_t>(std::lround(summary.control_points)), summary.psnr,
          std::filesystem::file_size(item.output), summary.frames};
}

Figures AnyJob::run(const Item& item, Room& room) const {
  const bool clip = transcode_ || is_video(item.input, {});
  return clip ? clips_.run(item, room) : pictures_.run(item, room);
}

}  // namespace knotreel::cli::batch
