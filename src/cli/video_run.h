// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "cli/distinct_paths.h"
#include "cli/vectorize_options.h"
#include "cli/video_options.h"
#include "knotreel/pipeline/job.h"

namespace knotreel::cli {

/// What `transcode`, and `vectorize` for a video, are asked to do.
struct VideoRun {
  std::string input;
  VideoInputOptions reading;
  VectorizeOptions options;
  track::TrackOptions tracking;
  bool no_drawn_frames = false;
  std::string document;      ///< empty: none
  std::string split_folder;  ///< empty: none
  pipeline::VideoOutput video;
  double scale = 1;          ///< of the video
  std::string size;          ///< of the video; wins over scale unless empty
  std::string side_by_side;  ///< video of input, result and knot mesh; empty: none
  std::string debug_dir;     ///< pictures of every frame; empty: none
  std::string stats;
  std::string progress;
  std::string trace;
  std::string digest;  ///< where that of all frames is printed afterwards; empty: nowhere
  int threads = 0;
};

/// Whether an input is to be read as a video: a folder, a pattern, a URL, or a file that is no picture.
bool is_video(const std::string& input, const VideoInputOptions& options);

/// The job for it. @param reader  of the input; must outlive the job.
pipeline::Job make_job(const VideoRun& run, video::VideoReader& reader);

/// All that it writes, whatever is printed in the end left out.
std::vector<Output> outputs_of(const VideoRun& run);

/// Does it, with all lines, files and warnings beside it.
/// @throws Error{kInterrupted} after a signal, when all files are whole; as check_paths().
pipeline::Summary run_video(const VideoRun& run);

/// What to warn of if `--frames` goes on behind the end of the video; else nothing.
std::vector<std::string> missing_frames(const VideoRun& run, const pipeline::Summary& summary);

/// What both commands say in the end: frames, time, quality.
std::string summary_text(const std::string& output, const pipeline::Summary& summary);

/// @throws Error{kInterrupted} that says so, always.
[[noreturn]] void throw_stopped(std::uint64_t frames);

/// @throws Error{kInterrupted} if the run was stopped; files are whole.
void check_stopped(const pipeline::Summary& summary);

}  // namespace knotreel::cli
