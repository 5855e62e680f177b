// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/video_run.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <thread>

#include "cli/command.h"
#include "cli/debug/video_debug.h"
#include "cli/file_names.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"
#include "cli/metrics_report.h"
#include "cli/output_size.h"
#include "cli/peak_memory.h"
#include "cli/printable.h"
#include "cli/side_by_side.h"
#include "cli/standard_input.h"
#include "cli/trace.h"
#include "cli/video_report.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/format.h"
#include "knotreel/pipeline/run.h"
#include "knotreel/video/picture_list.h"
#include "knotreel/video/turn.h"

namespace knotreel::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kStartBytes = 16;  // of a pipe: tell a picture, and nobody waits for more

/// @param most control points, if nothing is said about them.
vectorize::Options picture_options(const VideoRun& run, std::uint64_t pixels, std::size_t most) {
  VectorizeOptions given = run.options;
  if (!given.max_control_points) given.max_control_points = std::to_string(most);
  return effective_options(given, pixels, run.tracking.warm_start);
}

nlohmann::ordered_json head_json(const VideoRun& run, const pipeline::Job& job) {
  const video::StreamInfo& info = job.reader->info();
  return {{"version", KNOTREEL_VERSION},
          {"input", run.input},
          {"output", run.video.path},
          {"document", run.document},
          {"width", info.width},
          {"height", info.height},
          {"channels", info.channels},
          {"time_base", {info.time_base.num, info.time_base.den}},
          {"frame_rate", {info.frame_rate.num, info.frame_rate.den}},
          {"preset", run.options.preset},
          {"threads", run.threads},
          {"options", options_json(job.cold)},
          {"tracking", tracking_json(job.tracking)}};
}

}  // namespace

std::vector<std::string> missing_frames(const VideoRun& run, const pipeline::Summary& summary) {
  const std::string& wanted = run.reading.part.frames;
  if (wanted.empty() || summary.stopped) return {};
  const FrameRange range = parse_frames(wanted);
  if (!range.last || summary.frames > *range.last - range.first) return {};
  return {fmt::format("--frames {}: the video ends after {} of these {}", wanted, summary.frames,
                      counted(*range.last - range.first + 1, "frame"))};
}

pipeline::Job make_job(const VideoRun& run, video::VideoReader& reader) {
  const video::StreamInfo& info = reader.info();
  pipeline::Job job;
  job.reader = &reader;
  job.source = run.input;
  job.ssim = !run.stats.empty();
  const std::uint64_t pixels = std::uint64_t(info.width) * std::uint64_t(info.height);
  const auto film = [&](std::size_t most) {
    return vectorize::video_options(picture_options(run, pixels, most));
  };
  job.cold = film(vectorize::default_video_control_points(pixels));
  job.tracking = run.tracking;
  if (job.cold.features && !run.no_drawn_frames) {
    const auto drawn = [&](std::size_t most) {
      return std::make_shared<const vectorize::Options>(
          vectorize::drawn_video_options(picture_options(run, pixels, most)));
    };
    job.tracking.drawn = drawn(vectorize::default_drawn_video_control_points(pixels));
    // What is dense takes several times as long.
    if (!run.options.max_control_points && run.options.preset != "fast") {
      job.tracking.dense = drawn(vectorize::default_dense_drawn_video_control_points(pixels));
      job.tracking.cramped = drawn(vectorize::default_cramped_video_control_points(pixels));
      job.tracking.dense_film = std::make_shared<const vectorize::Options>(
          film(vectorize::default_dense_video_control_points(pixels)));
    }
  }
  job.document = run.document;
  job.split_folder = run.split_folder;
  job.video = run.video;
  const Size size = output_size(run.scale, run.size, info.width, info.height, video::turn_of(info));
  job.video.width = size.width;
  job.video.height = size.height;
  if (!run.side_by_side.empty()) {
    job.beside = run.side_by_side;
    job.compose = [turn = video::turn_of(info)](const image::Image& picture,
                                                const document::FrameModel& model) {
      return side_by_side(picture, model, turn);
    };
  }
  if (!run.debug_dir.empty()) job.watch = debug::watch_into(run.debug_dir);
  job.stop = [] { return interrupted(); };
  return job;
}

bool is_video(const std::string& input, const VideoInputOptions& options) {
  if (!options.format.empty()) return true;
  if (input == "-") {
    const std::vector<std::byte> start = peek_standard_input(kStartBytes);
    return !start.empty() && !image::detect_format(start);
  }
  std::error_code ignored;
  if (fs::is_directory(input, ignored) || input.find("://") != std::string::npos) return true;
  if (!fs::exists(input, ignored)) return video::means_pictures(input);
  if (!fs::is_regular_file(input, ignored)) return false;
  const std::vector<std::byte> start = read_start(input, video::kPictureStart);
  if (image::detect_format(start)) return !video::holds_one_picture(start, input);
  return !has_picture_name(input);
}

std::vector<Output> outputs_of(const VideoRun& run) {
  return {{run.document},
          split_output(run.split_folder),
          video_output(run.video.path, run.video.options.container),
          video_output(run.side_by_side),
          {run.stats},
          {run.progress},
          {run.trace},
          {run.digest}};
}

namespace {

/// Whoever gives one as a video has most likely taken the wrong command.
void check_no_document(const std::string& input) {
  if (!is_document(input)) return;
  throw Error(ErrorKind::kInput,
              quoted(input, "standard input") + " is a vector document already; 'knotreel render' draws it");
}

}  // namespace

pipeline::Summary run_video(const VideoRun& run) {
  check_paths({run.input}, outputs_of(run));
  check_document_name(run.document);
  check_no_document(run.input);
  const ThreadCap cap(run.threads);
  const video::ReadOptions reading = read_options(run.reading, run.threads);
  video::VideoReader reader = video::VideoReader::open(run.input, reading);
  if (run.reading.image_rate_is_told && reader.info().frame_rate != reading.image_rate)
    warn("--image-rate is not used: " + quoted(run.input, "standard input") + " has times of its own");
  pipeline::Job job = make_job(run, reader);
  ProgressFile progress(run.progress, reader.info().time_base);
  Trace trace(run.trace);
  VideoStats stats(run.stats, head_json(run, job));
  pipeline::Summary summary;
  {
    VideoLine line(reader.info().frames);
    job.on_frame = [&](const pipeline::FrameRow& row) {
      line.show(row);
      progress.show(row);
      trace.add(row);
      stats.add(row_json(row));
    };
    summary = pipeline::run_graph(job);
  }
  warn_all(reader.warnings());
  warn_all(summary.warnings);
  warn_all(missing_frames(run, summary));
  progress.end();
  trace.finish();
  auto tail = summary_json(summary);
  tail["damaged"] = reader.damaged();
  tail["peak_memory_bytes"] = peak_memory_bytes();
  stats.finish(tail);
  return summary;
}

std::string summary_text(const std::string& output, const pipeline::Summary& s) {
  std::string text = fmt::format("{}: {} in {:.1f} s ({:.2f} fps), busy {:.2f} of {}", printable(output),
                                 counted(s.frames, "frame"), s.seconds, s.fps, s.cpu_seconds / s.seconds,
                                 counted(std::thread::hardware_concurrency(), "core"));
  if (s.keyframes > 0)
    text += fmt::format(", {}, PSNR {}", counted(s.keyframes, "keyframe"), psnr_text(s.psnr));
  return text + fmt::format(", {:.0f} knots and {:.0f} control points per frame, {} bytes as document\n",
                            s.knots, s.control_points, s.document_bytes);
}

void throw_stopped(std::uint64_t frames) {
  throw Error(ErrorKind::kInterrupted, fmt::format("interrupted after {}; the outputs hold {} whole",
                                                   counted(frames, "frame"), frames == 1 ? "it" : "them"));
}

void check_stopped(const pipeline::Summary& summary) {
  if (summary.stopped) throw_stopped(summary.frames);
}

}  // namespace knotreel::cli
