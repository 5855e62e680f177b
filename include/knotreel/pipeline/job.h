// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/image/background.h"
#include "knotreel/motion/flow.h"
#include "knotreel/track/tracker.h"
#include "knotreel/vectorize/options.h"
#include "knotreel/vectorize/vectorize.h"
#include "knotreel/video/reader.h"
#include "knotreel/video/writer.h"

/// Whole videos through all modules: pictures in, vector models and pictures out, many frames at once.
namespace knotreel::pipeline {

/// When a stage worked on a frame, and on which thread.
struct StageSpan {
  std::string stage;
  std::chrono::steady_clock::time_point begin;
  std::chrono::steady_clock::time_point end;
  int thread = 0;  ///< 0, 1, 2, ... in the order in which threads came to their first stage
};

/// What became of one frame.
struct FrameRow {
  std::uint64_t index = 0;  ///< 0, 1, 2, ...
  std::int64_t pts = 0;     ///< ticks of the source's time base
  std::string start;        ///< as track::to_string(); empty if the model was only read
  std::size_t knots = 0;
  std::size_t control_points = 0;
  double mec = 0;                 ///< levels; of the stored model, drawn at the size of the source
  double meg = 0;                 ///< pixels, as track::curve_error(); 0: no features
  double psnr = 0;                ///< dB, likewise; infinite for equal pictures
  double ssim = 0;                ///< likewise; 0 if the job does not ask for it
  double survival = 0;            ///< share of the knots of the frame before that are in this one, 0 to 1
  double wanted_share = 0;        ///< of the pixels: track::FrameReport::wanted_control_points
  bool features_dropped = false;  ///< as track::FrameReport
  track::MeshChanges changes;     ///< of its mesh, and of that for the next frame
  std::uint64_t bytes = 0;        ///< of its chunk in the document
  double modelled_seconds = 0;    ///< since the start of the run, when its model was there; 0: only read
  double finished_seconds = 0;    ///< since the start of the run, when it was encoded
  std::vector<std::pair<std::string, double>> milliseconds;        ///< per stage, in order
  std::vector<std::pair<std::string, double>> model_milliseconds;  ///< within the stage "model"
  std::vector<StageSpan> spans;                                    ///< the stages again, with their times
};

/// Figures of a whole run. Means are over frames; PSNR is that of the mean squared error.
struct Summary {
  std::uint64_t frames = 0;
  double seconds = 0;
  double cpu_seconds = 0;  ///< of all threads of the process during the run
  double fps = 0;
  double first_frame_seconds = 0;  ///< until the first frame was encoded
  double psnr = 0;                 ///< dB; infinite for equal pictures
  double mec = 0;                  ///< levels
  double meg = 0;                  ///< pixels
  double ssim = 0;
  double knots = 0;
  double control_points = 0;
  double survival = 0;                ///< of the frames that have one before them in their group
  std::uint64_t keyframes = 0;        ///< cold starts
  std::uint64_t document_bytes = 0;   ///< of the document, all in, also if it was not kept
  bool stopped = false;               ///< by the caller, before the end of the source
  std::string digest;                 ///< of VideoWriter
  std::vector<std::string> warnings;  ///< one line each
};

/// A part of a picture.
struct Part {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// A video to write.
struct VideoOutput {
  std::string path;  ///< empty: none
  video::WriteOptions options;
  int width = 0;   ///< pixels; 0: as the source
  int height = 0;  ///< see width
  int depth = 0;   ///< bits per component; 0: as the source
  bool antialias = true;
  std::optional<Part> crop;      ///< in pixels of that size, inside it; none: all
  image::Background background;  ///< to put frames with alpha on
};

using Stop = std::function<bool()>;                          ///< from any thread, one at a time
using FrameObserver = std::function<void(const FrameRow&)>;  ///< in order, from any thread, one at a time

/// A picture to show beside the result, from a frame of the source and its stored model; called for several
/// frames at once. All have the same size, which is even, and three channels; turned as players show the
/// source.
using Compose = std::function<image::Image(const image::Image& picture, const document::FrameModel& model)>;

/// Somebody who looks at frames while they are made; called for several frames at once. May be empty.
struct Watch {
  /// Gives who looks at the stages of a frame that starts a group.
  std::function<vectorize::Observer(std::uint64_t frame)> cold;
  /// Looks at every frame as it was stored.
  std::function<void(std::uint64_t frame, const image::Image& picture, const document::FrameModel& model)>
      stored;
};

/// A video that becomes a document, another video, or both.
struct Job {
  video::VideoReader* reader = nullptr;  ///< at its start; outlives the run
  std::string source;                    ///< its name, for the document
  vectorize::Options cold;  ///< of frames made from their picture alone: vectorize::video_options()
  track::TrackOptions tracking;
  motion::FlowOptions flow{.turn_back = true};
  std::string document;      ///< file to write, `-` for standard output; empty: the document is not kept
  std::string split_folder;  ///< one document per frame goes there; empty: none
  VideoOutput video;
  Compose compose;     ///< what `beside` shows; null: nothing
  std::string beside;  ///< video of what compose() made
  Watch watch;
  /// Bounds the memory. 0: twice the number of threads, and two; of large frames one more than threads.
  int frames_in_flight = 0;
  Stop stop;  ///< true: no more frames; those begun and all files are finished
  FrameObserver on_frame;
  bool ssim = true;  ///< whether frames are measured by it, a fiftieth of all the time
};

}  // namespace knotreel::pipeline
