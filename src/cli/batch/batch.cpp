// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include "cli/batch/clip_job.h"
#include "cli/batch/run.h"
#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/vectorize_options.h"
#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

struct BatchArguments {
  batch::Places places;
  std::string manifest;
  bool resume = false;
  bool verbose = false;
  int jobs = 0;
  int threads = 0;
  double alone_above = 4;  // megapixels
  VectorizeOptions options;
  bool transcode = false;
  VideoRun clips;  ///< what only matters for clips
  VideoOutputOptions encoding;
};

batch::Crew crew_for(const BatchArguments& arguments, std::size_t items) {
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  const int threads = arguments.threads > 0 ? arguments.threads : std::max(cores, arguments.jobs);
  const int jobs = arguments.jobs > 0 ? arguments.jobs : cores;
  return {int(std::min<std::size_t>(std::size_t(std::min(jobs, threads)), items)), threads};
}

void make_output_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder))
    error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw Error(ErrorKind::kOutput, "cannot make folder '" + folder + "': " + error.message());
}

/// The folder of the inputs may be that of the outputs, and videos are called alike then.
void check_lot(const std::vector<batch::Item>& items, const std::string& list, const std::string& manifest) {
  std::vector<std::string> inputs;
  std::vector<Output> outputs{{manifest}};
  for (const batch::Item& item : items) {
    inputs.push_back(item.input);
    outputs.push_back({item.output});
  }
  std::error_code ignored;
  if (!std::filesystem::is_directory(list, ignored)) inputs.push_back(list);
  check_paths(inputs, outputs);
}

/// The manifest may have standard output for itself.
batch::Telling telling_of(const BatchArguments& arguments) {
  if (arguments.manifest == "-") return batch::Telling::kNothing;
  return arguments.verbose ? batch::Telling::kItems : batch::Telling::kSum;
}

/// Options that would be without effect are refused.
void check_encoding(const CLI::App& command, bool transcode) {
  for (const char* name :
       {"--codec", "--crf", "--encoder-preset", "--pixel-format", "--encoder-option", "--container-option"}) {
    if (transcode || command.count(name) == 0) continue;
    throw Error(ErrorKind::kInvalidArgument,
                std::string(name) + " is for --transcode; documents are not encoded");
  }
}

void run_batch(const CLI::App& command, const BatchArguments& arguments) {
  check_encoding(command, arguments.transcode);
  effective_options(arguments.options, 1);  // wrong ones are told of now
  batch::Places places = arguments.places;
  places.clips_only = arguments.transcode;
  if (arguments.transcode) places.extension = ".mp4";
  batch::Lot lot;
  lot.items = batch::find_items(places);
  lot.crew = crew_for(arguments, lot.items.size());
  const std::string path = arguments.manifest.empty()
                               ? (std::filesystem::path(arguments.places.output) / "manifest.jsonl").string()
                               : arguments.manifest;
  check_lot(lot.items, places.input, path);
  if (path == "-" && arguments.resume) {
    throw Error(ErrorKind::kInvalidArgument, "--resume needs a manifest that is a file");
  }
  make_output_folder(arguments.places.output);
  if (arguments.resume) lot.before = batch::read_manifest(path);
  batch::Manifest manifest(path, arguments.resume);
  batch::Progress progress(lot.items.size(), telling_of(arguments));
  const double alone_above = 1e6 * arguments.alone_above;
  VideoRun run = arguments.clips;
  run.options = arguments.options;
  // With a format that is told, a name with "%d" in it is that of one file.
  if (arguments.transcode) run.video.options = write_options(arguments.encoding, "mp4", 0);
  const batch::PictureJob pictures(arguments.options, alone_above);
  const batch::ClipJob clips(run, arguments.transcode, alone_above);
  batch::run_lot(lot, batch::AnyJob(pictures, clips, arguments.transcode), manifest, progress);
}

void add_places(CLI::App& command, BatchArguments& arguments) {
  command
      .add_option("INPUT", arguments.places.input,
                  "Folder of pictures and videos, or text file with one path per line;\n'-': such lines on "
                  "standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", arguments.places.output, "Folder for the documents, made if missing")
      ->type_name("DIR")
      ->required();
  command.add_flag("--recursive", arguments.places.recursive, "Also the folders in the input folder");
  command
      .add_option("--manifest", arguments.manifest,
                  "Write a line of JSON for every picture that is through (default\n"
                  "manifest.jsonl among the documents); '-': standard output")
      ->type_name("FILE");
  command.add_flag("--resume", arguments.resume,
                   "Go on with the manifest: skip what is done and has not changed");
}

void add_effort(CLI::App& command, BatchArguments& arguments) {
  command.add_option("--jobs", arguments.jobs, "Most pictures at once, up to 1024; 0: one per core")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--alone-above", arguments.alone_above,
                  "Pictures of more megapixels are worked on alone, for their memory")
      ->check(within(0, 1000))
      ->type_name("MP")
      ->capture_default_str();
  command.add_flag("-v,--verbose", arguments.verbose, "A line for every picture");
  add_threads_option(command, arguments.threads);
  add_quiet_option(command);
}

void add_clips(CLI::App& command, BatchArguments& arguments) {
  command.option_defaults()->group("Videos");
  command.add_flag("--transcode", arguments.transcode,
                   "Turn videos into videos (.mp4) as 'knotreel transcode' does, and leave\nout pictures");
  add_video_output_options(command, arguments.encoding);
  add_tracking_options(command, arguments.clips.tracking, arguments.clips.no_drawn_frames);
  add_video_input_options(command, arguments.clips.reading);
  command.option_defaults()->group("Options");
}

constexpr const char* kBatchFooter = R"(
photo.png becomes photo.tcb and clip.mp4 clip.tcb, as 'knotreel vectorize' makes them. Those that would get
the same document keep their extensions: a.png.tcb, a.jpg.tcb. What cannot be read does not stop the others.
Exit codes: 0 all done, 3 some inputs failed, 4 some outputs could not be written, 130 interrupted.
Examples:
  knotreel batch photos -o documents
  knotreel batch photos -o documents --resume
  knotreel batch clips -o large --transcode --crf 20
  find . -name '*.png' | knotreel batch - -o documents --preset fast --jobs 4 -v)";

}  // namespace

void add_batch_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("batch", "Turn many pictures and videos into vector documents");
  const auto arguments = std::make_shared<BatchArguments>();
  add_places(*command, *arguments);
  add_vectorize_options(*command, arguments->options, kBoundOfPicturesAndVideos);
  add_effort(*command, *arguments);
  add_clips(*command, *arguments);
  command->footer(kBatchFooter);
  command->callback([command, arguments] { run_batch(*command, *arguments); });
}

}  // namespace knotreel::cli
