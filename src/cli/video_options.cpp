#include "cli/video_options.h"

#include <charconv>
#include <cmath>

#include "cli/command.h"
#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
  throw Error(ErrorKind::kInvalidArgument, option + " takes " + wanted + ", not '" + text + "'");
}

template <typename Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
}

}  // namespace

void add_video_input_options(CLI::App& command, VideoInputOptions& options) {
  command.add_option("--input-format", options.format, "Format of the video, if its content does not say it")
      ->type_name("NAME");
  command
      .add_option("--input-option", options.demuxer,
                  "For the reader of that format, such as video_size=640x480")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--image-rate", options.image_rate, "Frames per second of a folder of pictures")
      ->type_name("R")
      ->capture_default_str();
  CLI::Option* frames =
      command
          .add_option("--frames", options.frames,
                      "Only these frames of the video, counted from 0, and their sound; A- is up\nto the end")
          ->type_name("A-B");
  command
      .add_option(
          "--start", options.start,
          "Only frames from this time on, counted from the first frame, in seconds\nor as [HH:]MM:SS.S")
      ->type_name("TIME")
      ->excludes(frames);
  command.add_option("--end", options.end, "Only frames before this time")
      ->type_name("TIME")
      ->excludes(frames);
  command.add_flag("--strict", options.strict,
                   "Damage in a video is an error; without, what can be\n"
                   "decoded is used, and a warning tells of the rest");
}

void add_video_output_options(CLI::App& command, VideoOutputOptions& options) {
  command
      .add_option("--codec", options.codec,
                  "h264, hevc, vp9, av1, ffv1, prores or a name of libav; without, what\nsuits the container")
      ->type_name("NAME");
  command.add_option("--crf", options.crf, "Quality on the encoder's own scale, lower is better")
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

void add_tracking_options(CLI::App& command, track::TrackOptions& options) {
  command.add_flag("!--no-warm-start", options.warm_start,
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
}

video::Rational parse_rate(const std::string& option, const std::string& text) {
  const std::size_t slash = text.find('/');
  video::Rational rate;
  double value = 0;
  if (slash != std::string::npos) {
    const std::string_view all = text;
    if (!parse(all.substr(0, slash), rate.num) || !parse(all.substr(slash + 1), rate.den)) rate = {};
  } else if (parse(std::string_view(text), value) && value <= 100000) {
    const bool whole = value == std::floor(value);
    rate =
        whole ? video::Rational{std::int64_t(value), 1} : video::Rational{std::llround(value * 1000), 1000};
  }
  if (!rate.known() || rate.num > 0x7fffffff || rate.den > 0x7fffffff) {
    refuse(option, text, "frames per second such as 25 or 30000/1001");
  }
  return rate;
}

FrameRange parse_frames(const std::string& text) {
  constexpr const char* kWanted = "A-B, A- or A, with whole numbers, B not below A";
  const auto number = [&](std::string_view word) {
    std::uint32_t value = 0;
    if (!parse(word, value)) refuse("--frames", text, kWanted);
    return value;
  };
  const std::string_view all = text;
  const std::size_t dash = all.find('-');
  FrameRange range{number(all.substr(0, dash)), {}};
  if (dash == std::string_view::npos) {
    range.last = range.first;
  } else if (dash + 1 < all.size()) {
    range.last = number(all.substr(dash + 1));
  }
  if (range.last && *range.last < range.first) refuse("--frames", text, kWanted);
  return range;
}

double parse_time(const std::string& option, const std::string& text) {
  constexpr const char* kWanted = "seconds or [HH:]MM:SS, such as 75.5 or 1:15.5";
  std::string_view left = text;
  double seconds = 0;
  for (int parts = 1;; ++parts) {
    const std::size_t colon = left.find(':');
    double value = 0;
    if (colon != std::string_view::npos) {
      std::uint32_t whole = 0;
      if (parts == 3 || !parse(left.substr(0, colon), whole)) refuse(option, text, kWanted);
      value = whole;
    } else if (!parse(left, value) || !(value >= 0 && value <= 1e9)) {
      refuse(option, text, kWanted);
    }
    if (parts > 1 && value >= 60) refuse(option, text, kWanted);
    seconds = 60 * seconds + value;
    if (colon == std::string_view::npos) return seconds;
    left.remove_prefix(colon + 1);
  }
}

video::ReadOptions read_options(const VideoInputOptions& given, int threads) {
  video::ReadOptions options;
  options.threads = threads;
  options.strict = given.strict;
  options.copy_streams = !given.no_copy_streams;
  options.format = given.format;
  options.image_rate = parse_rate("--image-rate", given.image_rate);
  if (!given.frames.empty()) {
    const FrameRange range = parse_frames(given.frames);
    options.part.first = range.first;
    if (range.last) options.part.count = *range.last - range.first + 1;
  }
  if (!given.start.empty()) options.part.start = parse_time("--start", given.start);
  if (!given.end.empty()) options.part.end = parse_time("--end", given.end);
  if (options.part.end <= options.part.start) refuse("--end", given.end, "a time behind the start");
  for (const std::string& pair : given.demuxer) {
    const std::size_t sign = pair.find('=');
    if (sign == std::string::npos || sign == 0) refuse("--input-option", pair, "KEY=VALUE");
    options.demuxer_options[pair.substr(0, sign)] = pair.substr(sign + 1);
  }
  return options;
}

video::WriteOptions write_options(const VideoOutputOptions& given, const std::string& container,
                                  int threads) {
  video::WriteOptions options;
  options.codec = given.codec;
  options.crf = given.crf;
  options.preset = given.preset;
  options.pixel_format = given.pixel_format;
  options.container = container;
  options.threads = threads;
  return options;
}

nlohmann::ordered_json tracking_json(const track::TrackOptions& o) {
  return {{"warm_start", o.warm_start},
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
