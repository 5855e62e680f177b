// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/command.h"
#include "cli/file_names.h"
#include "cli/parse.h"
#include "cli/video_run.h"
#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

struct TranscodeArguments {
  VideoRun run;
  VideoOutputOptions encoding;
  std::string background;
  std::string format;
};

void transcode(TranscodeArguments& arguments) {
  VideoRun& run = arguments.run;
  const bool nowhere = arguments.format == "null" || arguments.format == "hash";
  if (run.video.path.empty() && !nowhere) {
    throw Error(ErrorKind::kInvalidArgument, "--output is required (see knotreel transcode --help)");
  }
  warn_if_not_written(run.video.path, arguments.format);
  if (arguments.format.empty()) check_rendering_name(run.video.path, "vectorize");
  const std::string output = run.video.path.empty() ? "-" : run.video.path;
  run.video.path = nowhere ? arguments.format : output;  // these write no file
  run.video.options = write_options(arguments.encoding, arguments.format, run.threads);
  if (arguments.format == "hash") run.digest = output;
  run.video.background = parse_background(arguments.background);
  const pipeline::Summary summary = run_video(run);
  if (!run.digest.empty()) {
    write_text(run.digest, summary.digest + "\n");
  } else if (!uses_standard_output(outputs_of(run))) {
    tell_result(summary_text(run.video.path, summary));
  }
  check_stopped(summary);
}

void add_outputs(CLI::App& command, TranscodeArguments& arguments) {
  VideoRun& run = arguments.run;
  command
      .add_option("-o,--output", run.video.path,
                  "Video to write; its name says the container, and frame_%04d.png means\n"
                  "a picture per frame. '-': standard output")
      ->type_name("FILE");
  auto* scale = command.add_option("--scale", run.scale, "Output pixels per pixel of the video, above 0")
                    ->type_name("S")
                    ->capture_default_str();
  command.add_option("--size", run.size, "Size of the output in pixels")->type_name("WxH")->excludes(scale);
  command
      .add_option("-f,--format", arguments.format,
                  "Container, if the name does not say it; null: none is written;\n"
                  "hash: print a digest of all frames and times")
      ->type_name("NAME");
  add_background_option(command, arguments.background);
  add_video_output_options(command, arguments.encoding);
  command.add_flag("--no-copy-streams", run.reading.no_copy_streams, "Leave sound and subtitles away");
  command.add_option("--document", run.document, "Keep the vector documents too (.tcb)")->type_name("FILE");
  command
      .add_option("--side-by-side", run.side_by_side,
                  "A second video to look at: the input, the result enlarged, the knot mesh")
      ->type_name("FILE");
  add_progress_option(command, run.progress);
  command
      .add_option("--stats", run.stats,
                  "Write options, and counts, quality and time of every frame, as JSON;\n"
                  "'-': standard output")
      ->type_name("FILE");
  add_trace_option(command, run.trace);
  command
      .add_option("--debug-dir", run.debug_dir,
                  "Write PNG pictures of how frames were made, into a folder for each")
      ->type_name("DIR");
}

constexpr const char* kTranscodeFooter = R"(
Every picture becomes a vector model, made from that of the picture before, and is drawn again from what
the document holds, at any size. Times, sound, subtitles and colour tags are kept. After Ctrl-C the outputs
hold the frames done so far.
Examples:
  knotreel transcode in.mp4 -o out.mp4
  knotreel transcode in.mp4 -o large.mkv --scale 2 --codec hevc --document in.tcb
  knotreel transcode in.mp4 -f null --stats figures.json
  knotreel transcode pictures/ -o out.mp4 --image-rate 30)";

}  // namespace

void add_transcode_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "transcode", "Turn a video into vector graphics and back into a video of any size");
  const auto arguments = std::make_shared<TranscodeArguments>();
  command
      ->add_option("VIDEO", arguments->run.input,
                   "Video, folder of pictures or pattern such as in_%04d.png; '-': standard\ninput")
      ->type_name("")
      ->required();
  add_outputs(*command, *arguments);
  add_threads_option(*command, arguments->run.threads);
  add_no_overwrite_option(*command);
  add_quiet_option(*command);
  command->option_defaults()->group("Reading");
  add_video_input_options(*command, arguments->run.reading);
  command->option_defaults()->group("Video");
  add_tracking_options(*command, arguments->run.tracking, arguments->run.no_drawn_frames);
  command->option_defaults()->group("Options");
  add_vectorize_options(
      *command, arguments->run.options,
      "2%, of small videos 20% up to 1500,\nup to 10% with captions; of drawn frames 2%,\n"
      "or 20% up to 3000, or 10% (20% up to 50,000,\n30% up to 75,000) if their outlines ask for it");
  command->footer(kTranscodeFooter);
  command->callback([arguments] { transcode(*arguments); });
}

}  // namespace knotreel::cli
