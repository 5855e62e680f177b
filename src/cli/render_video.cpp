// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/render_video.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/document_part.h"
#include "cli/file_names.h"
#include "cli/interrupt.h"
#include "cli/output_size.h"
#include "cli/pictures.h"
#include "cli/video_report.h"
#include "cli/video_run.h"
#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/pipeline/render_job.h"
#include "knotreel/pipeline/sequence.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli {
namespace {

pipeline::RenderJob make_job(const RenderArguments& arguments, document::Reader& reader) {
  pipeline::RenderJob job;
  job.reader = &reader;
  const FrameRange range = frames_of(reader, part_of(arguments.part));
  job.first = range.first;
  job.last = range.last;
  if (!arguments.fps.empty()) job.rate = parse_rate("--fps", arguments.fps);
  const document::SequenceInfo& info = reader.info();
  const Turn turn = turn_of(reader);
  const Size size = output_size(arguments.scale, arguments.size, info.width, info.height, turn);
  job.video.path = arguments.output;
  job.video.options = write_options(arguments.encoding, arguments.format, arguments.threads);
  job.video.width = size.width;
  job.video.height = size.height;
  if (!arguments.crop.empty()) {
    const Rect crop = parse_crop(arguments.crop, size, turn);
    job.video.crop = {crop.x, crop.y, crop.width, crop.height};
  }
  job.video.background = parse_background(arguments.background);
  job.video.options.samples = samples_of(arguments);
  if (!arguments.depth.empty()) job.video.depth = arguments.depth == "8" ? 8 : 16;
  job.video.antialias = !arguments.aliased;
  job.stop = [] { return interrupted(); };
  return job;
}

/// The video whose sound goes along, if there is one.
std::optional<video::VideoReader> open_copied(const RenderArguments& arguments) {
  if (arguments.copied.empty()) return {};
  video::ReadOptions options;
  options.threads = 1;
  options.chapters = arguments.part.whole();
  video::VideoReader reader = video::VideoReader::open(arguments.copied, options);
  const auto streams = reader.streams();
  const auto is_other = [](const video::StreamEntry& stream) { return stream.kind != "video"; };
  if (std::none_of(streams.begin(), streams.end(), is_other)) {
    warn("'" + arguments.copied + "' has neither sound nor subtitles");
  }
  return reader;
}

nlohmann::ordered_json head_json(const RenderArguments& arguments, const pipeline::RenderJob& job,
                                 const document::SequenceInfo& info) {
  const video::Rational rate = job.rate.known() ? job.rate : pipeline::stream_info(info).frame_rate;
  return {{"version", KNOTREEL_VERSION},
          {"input", arguments.input},
          {"output", arguments.output},
          {"width", job.video.crop ? job.video.crop->width : job.video.width},
          {"height", job.video.crop ? job.video.crop->height : job.video.height},
          {"frame_rate", {rate.num, rate.den}},
          {"threads", arguments.threads}};
}

void tell(const RenderArguments& arguments, const pipeline::Summary& summary) {
  warn_all(summary.warnings);
  if (arguments.format == "hash") {
    write_text(arguments.output, summary.digest + "\n");
  } else if (!uses_standard_output(outputs_of(arguments))) {
    tell_result(summary_text(arguments.output, summary));
  }
}

}  // namespace

std::optional<image::SampleType> samples_of(const RenderArguments& arguments) {
  if (arguments.depth.empty()) return {};
  if (arguments.depth == "float") return image::SampleType::f32;
  return arguments.depth == "8" ? image::SampleType::u8 : image::SampleType::u16;
}

std::vector<Output> outputs_of(const RenderArguments& arguments) {
  const bool digest = arguments.format == "hash";
  return {digest ? Output{arguments.output} : video_output(arguments.output, arguments.format),
          {arguments.stats},
          {arguments.progress}};
}

void add_render_video_options(CLI::App& command, RenderArguments& options) {
  command.option_defaults()->group(kVideoGroup);
  add_part_options(command, options.part, "Only these frames, counted from 0; A- is up to the end");
  command
      .add_option("--fps", options.fps,
                  "Frames per second, such as 25 or 30000/1001: frames in between are made\n"
                  "of what moves on from one to the next, but not across cuts. Without, each\n"
                  "has the time that the document says")
      ->type_name("R");
  command
      .add_option("--copy-streams", options.copied,
                  "Take sound, subtitles and titles from this file, the video that the\n"
                  "document was made from; of a part, that time")
      ->type_name("FILE");
  add_video_output_options(command, options.encoding);
  add_progress_option(command, options.progress);
  command
      .add_option("--stats", options.stats,
                  "Write counts, bytes and time of every frame as JSON; '-': standard output")
      ->type_name("FILE");
  command.option_defaults()->group("Options");
}

namespace {

bool is_for_pictures(const RenderArguments& arguments) {
  return arguments.format.empty() && video::number_pattern(arguments.output);
}

void check_copied(const RenderArguments& arguments) {
  if (arguments.copied.empty()) return;
  if (arguments.copied == "-" && arguments.input == "-") {
    throw Error(ErrorKind::kInvalidArgument, "the document and --copy-streams cannot both be standard input");
  }
  const std::string& format = arguments.format;
  if (format == "null" || format == "hash" || is_for_pictures(arguments)) {
    throw Error(ErrorKind::kInvalidArgument,
                "--copy-streams is for video files: pictures, null and hash hold no sound");
  }
}

}  // namespace

bool is_video_output(const std::string& output, const std::string& format) {
  if (video::number_pattern(output)) return true;
  if (format == "null" || format == "hash") return true;
  if (!format.empty()) return !has_picture_name(output) && !image::format_of_extension(format);
  return std::filesystem::path(output).has_extension() && !has_picture_name(output);
}

void check_video(const RenderArguments& arguments) {
  check_copied(arguments);
  part_of(arguments.part);
  if (!arguments.fps.empty()) parse_rate("--fps", arguments.fps);
  if (arguments.depth == "float" && !is_for_pictures(arguments)) {
    throw Error(ErrorKind::kInvalidArgument, "--depth float is for pictures (pfm, tiff), not for videos");
  }
}

void render_video(const RenderArguments& arguments, document::Reader& reader) {
  pipeline::RenderJob job = make_job(arguments, reader);
  std::optional<video::VideoReader> copied = open_copied(arguments);
  if (copied) job.copied = &*copied;
  const video::Rational ticks = pipeline::stream_info(reader.info()).time_base;
  ProgressFile progress(arguments.progress,
                        job.rate.known() ? video::Rational{job.rate.den, job.rate.num} : ticks);
  VideoStats stats(arguments.stats, head_json(arguments, job, reader.info()));
  pipeline::Summary summary;
  {
    VideoLine line(pipeline::frame_count(job));
    job.on_frame = [&](const pipeline::FrameRow& row) {
      line.show(row);
      progress.show(row);
      stats.add(drawn_json(row));
    };
    summary = pipeline::run_render(job);
  }
  if (copied) warn_of(arguments.copied, copied->warnings());
  progress.end();
  stats.finish({{"frame_count", summary.frames},
                {"seconds", summary.seconds},
                {"fps", summary.fps},
                {"knots", summary.knots},
                {"control_points", summary.control_points},
                {"document_bytes", summary.document_bytes},
                {"interrupted", summary.stopped}});
  tell(arguments, summary);
  check_stopped(summary);
}

}  // namespace knotreel::cli
