// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/video_options.h"

#include <map>

#include "cli/command.h"
#include "cli/parse.h"

namespace knotreel::cli {
namespace {

void add_pairs_option(CLI::App& command, const char* name, std::vector<std::string>& pairs,
                      const char* description) {
  command.add_option(name, pairs, description)->type_name("KEY=VALUE")->allow_extra_args(false);
}

std::map<std::string, std::string> parse_pairs(const char* option, const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> result;
  for (const std::string& pair : pairs) {
    const std::size_t sign = pair.find('=');
    if (sign == std::string::npos || sign == 0) refuse(option, pair, "KEY=VALUE");
    result[pair.substr(0, sign)] = pair.substr(sign + 1);
  }
  return result;
}

}  // namespace

void add_video_input_options(CLI::App& command, VideoInputOptions& options) {
  command.add_option("--input-format", options.format, "Format of the video, if its content does not say it")
      ->type_name("NAME");
  add_pairs_option(command, "--input-option", options.demuxer,
                   "For the reader of that format, such as video_size=640x480");
  command.add_option("--image-rate", options.image_rate, "Frames per second of a folder of pictures")
      ->each([&options](const std::string&) { options.image_rate_is_told = true; })
      ->type_name("R")
      ->capture_default_str();
  add_deinterlace_option(command, options.deinterlace);
  command
      .add_option("--filter", options.filter,
                  "Filters for the frames of a video before anything else, as ffmpeg -vf\n"
                  "takes them, such as crop=640:360,hqdn3d")
      ->type_name("GRAPH");
  add_part_options(command, options.part,
                   "Only these frames of the video, counted from 0, and their sound; A- is up\nto the end");
  command.add_flag("--strict", options.strict,
                   "Damage in a video is an error; without, what can be\n"
                   "decoded is used, and a warning tells of the rest");
}

void add_deinterlace_option(CLI::App& command, std::string& mode) {
  command
      .add_option("--deinterlace", mode,
                  "auto: frames that say they are interlaced show the first of their\n"
                  "two moments; all: as auto, whatever frames say; fields: both moments\n"
                  "of all frames, at twice the rate; no: both in one, line by line")
      ->check(CLI::IsMember({"auto", "no", "all", "fields"}).description(""))
      ->type_name("MODE")
      ->capture_default_str();
}

video::Deinterlace deinterlace_mode(const std::string& name) {
  if (name == "no") return video::Deinterlace::kNone;
  if (name == "all") return video::Deinterlace::kAll;
  return name == "fields" ? video::Deinterlace::kFields : video::Deinterlace::kMarked;
}

void add_video_output_options(CLI::App& command, VideoOutputOptions& options) {
  command
      .add_option("--codec", options.codec,
                  "h264, hevc, vp9, av1, ffv1, prores or a name of libav; without, what\nsuits the container")
      ->type_name("NAME");
  command
      .add_option("--crf", options.crf,
                  "Quality on the encoder's own scale, lower is better: 0 to 51 of h264\nand hevc, 0 to 63 "
                  "of vp9, vp8 and av1")
      ->check(within(0, 255))
      ->type_name("Q");
  command
      .add_option("--encoder-preset", options.preset,
                  "Effort of the encoder, such as slow; h264: faster if not given")
      ->type_name("NAME");
  command
      .add_option("--pixel-format", options.pixel_format,
                  "A name of libav, such as yuv420p; without, the source's or the nearest\nto it")
      ->type_name("NAME");
  add_pairs_option(command, "--encoder-option", options.encoder,
                   "For the encoder, by libav's names, such as b=2M, g=50 or tune=animation");
  add_pairs_option(command, "--container-option", options.container,
                   "For the container, by libav's names, such as movflags=+faststart");
}

void add_progress_option(CLI::App& command, std::string& file) {
  command.add_option("--progress", file, "Write lines key=value after every frame; '-': standard output")
      ->type_name("FILE");
}

void add_trace_option(CLI::App& command, std::string& file) {
  command
      .add_option("--trace", file,
                  "Write when each thread worked on which stage of which frame, for\n"
                  "chrome://tracing or Perfetto")
      ->type_name("FILE");
}

void add_tracking_options(CLI::App& command, track::TrackOptions& options, bool& no_drawn_frames) {
  command.add_flag_callback(
      "--no-warm-start", [&options] { options.warm_start = false; },
      "Make every frame from its picture alone, not from the frame before");
  command
      .add_option("--temporal-weight", options.temporal_weight,
                  "How much of its error a frame keeps along motion, 0 to 1 (twice\nwhere nothing moves): "
                  "less flicker")
      ->check(within(0, 1))
      ->type_name("W")
      ->capture_default_str();
  command
      .add_option("--keyframe-interval", options.keyframe_interval,
                  "Most frames that come from each other; then one is made anew")
      ->check(CLI::Range(1, 1000000).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--scene-threshold", options.scene_threshold,
                  "How unlike pictures are at a cut, 0 (none are alike) to 1 (no cuts)")
      ->check(within(0, 1))
      ->type_name("T")
      ->capture_default_str();
  command.add_flag(
      "--no-drawn-frames", no_drawn_frames,
      "Make drawings as film is made: their outlines follow those of the\nframe before, in place of "
      "being found anew");
}

video::ReadOptions read_options(const VideoInputOptions& given, int threads) {
  video::ReadOptions options;
  options.threads = threads;
  options.strict = given.strict;
  options.copy_streams = !given.no_copy_streams;
  options.format = given.format;
  options.image_rate = parse_rate("--image-rate", given.image_rate);
  options.deinterlace = deinterlace_mode(given.deinterlace);
  options.filter = given.filter;
  options.part = part_of(given.part);
  options.demuxer_options = parse_pairs("--input-option", given.demuxer);
  return options;
}

video::WriteOptions write_options(const VideoOutputOptions& given, const std::string& container,
                                  int threads) {
  video::WriteOptions options;
  options.codec = given.codec;
  options.crf = given.crf;
  options.preset = given.preset;
  options.pixel_format = given.pixel_format;
  options.encoder_options = parse_pairs("--encoder-option", given.encoder);
  options.container_options = parse_pairs("--container-option", given.container);
  options.container = container;
  options.threads = threads;
  return options;
}

void warn_if_not_written(const std::string& output, const std::string& format) {
  if (format == "null" && !output.empty() && output != "-")
    warn("'" + output + "' is not written: --format is null");
}

nlohmann::ordered_json tracking_json(const track::TrackOptions& o) {
  return {{"warm_start", o.warm_start},
          {"drawn_frames", o.drawn != nullptr},
          {"drawn_max_control_points", o.drawn ? o.drawn->max_control_points : 0},
          {"dense_max_control_points", o.dense ? o.dense->max_control_points : 0},
          {"dense_film_max_control_points", o.dense_film ? o.dense_film->max_control_points : 0},
          {"cramped_max_control_points", o.cramped ? o.cramped->max_control_points : 0},
          {"drawn_fine_grid", o.drawn && o.drawn->fine_grid != vectorize::FineGrid::kNone},
          {"temporal_weight", o.temporal_weight},
          {"keyframe_interval", o.keyframe_interval},
          {"scene_threshold", o.scene_threshold},
          {"drift", o.drift},
          {"look_interval", o.look_interval},
          {"rework_interval", o.rework_interval},
          {"bend_interval", o.bend_interval},
          {"knot_bits", o.knot_bits},
          {"displacement_step", o.displacement_step},
          {"colour_step", o.colour_step},
          {"delta_coarseness", o.delta_coarseness},
          {"restart_gain", o.restart_gain}};
}

}  // namespace knotreel::cli
