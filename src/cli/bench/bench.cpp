// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

#include "bench_clips.h"
#include "cli/bench/compare.h"
#include "cli/bench/machine.h"
#include "cli/bench/measure.h"
#include "cli/bench/tables.h"
#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/video_options.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchArguments {
  std::vector<std::string> clips;
  std::vector<std::string> sizes;
  std::vector<std::string> presets{"balanced"};
  std::vector<int> threads{1, 2};
  std::uint64_t frames = 0;
  std::string max_control_points;
  std::string transcode_options;
  VideoOutputOptions encoding;
  std::string json;
  bool markdown = false;
  std::vector<std::string> compare;
  double threshold = 10;
  std::string passthrough;
};

bench::Result read_result(const std::string& path) {
  std::ifstream file(path);
  try {
    return bench::result_of(Json::parse(file));
  } catch (const Json::exception&) {
    throw Error(ErrorKind::kInput, "'" + path + "' is no result of knotreel bench");
  }
}

/// The options of the encoder as `transcode` takes them.
std::vector<std::string> encoding_words(const VideoOutputOptions& options) {
  std::vector<std::string> words;
  const auto add = [&](const char* name, const std::string& value) {
    if (value.empty()) return;
    words.push_back(name);
    words.push_back(value);
  };
  add("--codec", options.codec);
  if (options.crf >= 0) add("--crf", fmt::format("{}", options.crf));
  add("--encoder-preset", options.preset);
  add("--pixel-format", options.pixel_format);
  for (const std::string& pair : options.encoder) add("--encoder-option", pair);
  for (const std::string& pair : options.container) add("--container-option", pair);
  return words;
}

bench::Setting setting_of(const BenchArguments& arguments, const std::string& preset) {
  bench::Setting setting{preset, arguments.threads, encoding_words(arguments.encoding), {}};
  if (!arguments.max_control_points.empty()) {
    setting.vectorization = {"--max-control-points", arguments.max_control_points};
  }
  std::istringstream words(arguments.transcode_options);
  for (std::string word; words >> word;) setting.vectorization.push_back(word);
  return setting;
}

/// Of clips without a size of their own, all that are usual; files stay as they are.
std::vector<std::optional<Size>> sizes_of(const BenchArguments& arguments) {
  std::vector<std::optional<Size>> sizes;
  for (const std::string& text : arguments.sizes) sizes.emplace_back(parse_size("--size", text));
  if (!sizes.empty()) return sizes;
  if (!arguments.clips.empty()) return {std::nullopt};
  return {Size{352, 288}, Size{640, 360}, Size{1280, 720}};
}

/// Adds to `result` as it goes on, so that something is left after an interruption.
void measure_all(const BenchArguments& arguments, Json& result) {
  const bench::Scratch scratch;
  ProgressLine line;
  const auto& clips = arguments.clips.empty() ? media::bench_clip_names() : arguments.clips;
  for (const std::string& wanted : clips) {
    for (const std::optional<Size>& size : sizes_of(arguments)) {
      const bench::Clip clip = bench::prepare_clip(wanted, size, arguments.frames, scratch);
      for (const std::string& preset : arguments.presets) {
        const Json runs = bench::measure_clip(clip, setting_of(arguments, preset), scratch);
        if (!arguments.markdown && arguments.json != "-") {
          const bool first = result["runs"].empty();
          write_text("-", (first ? bench::surroundings_text(result) : "") + bench::runs_text(runs));
        }
        result["runs"].insert(result["runs"].end(), runs.begin(), runs.end());
        line.show(fmt::format("{} {}x{} {}", clip.name, clip.width, clip.height, preset));
      }
    }
  }
}

void measure(const BenchArguments& arguments) {
  Json result = bench::surroundings_json();
  result["arguments"] = {{"max_control_points", arguments.max_control_points},
                         {"transcode_options", arguments.transcode_options},
                         {"encoding", encoding_words(arguments.encoding)}};
  result["runs"] = Json::array();
  std::optional<OutputFile> json;
  if (!arguments.json.empty()) json.emplace(arguments.json);  // first: better to fail before the work
  try {
    measure_all(arguments, result);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::kInterrupted) throw;
  }
  if (arguments.markdown) write_text("-", bench::markdown(result));
  if (json) {
    json->write(result.dump(2) + "\n");
    json->commit();
  }
  check_interrupted();
}

void check_outputs(const BenchArguments& arguments) {
  std::vector<Output> outputs{{arguments.json}, video_output(arguments.passthrough)};
  if (arguments.markdown || !arguments.passthrough.empty()) outputs.push_back({"-"});
  check_paths(arguments.clips, outputs);
}

/// Options that would be without effect are refused, and so are clips: others were meant to be measured.
void check_use(const CLI::App& command, const char* mode, const std::set<std::string>& useful) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || useful.contains(name)) continue;
    throw Error(ErrorKind::kInvalidArgument,
                (name == "CLIPS" ? "clips are" : name + " is") + std::string(" of no use with ") + mode);
  }
}

void check_arguments(const CLI::App& command, const BenchArguments& arguments) {
  if (!arguments.compare.empty()) {
    check_use(command, "--compare", {"--compare", "--threshold"});
  } else if (!arguments.passthrough.empty()) {
    check_use(command, "--passthrough",
              {"CLIPS", "--passthrough", "--threads", "--codec", "--crf", "--encoder-preset",
               "--pixel-format", "--encoder-option", "--container-option"});
    if (arguments.clips.size() != 1) throw Error(ErrorKind::kInvalidArgument, "--passthrough takes one clip");
    if (command.count("--threads") > 0 && arguments.threads.size() != 1)
      throw Error(ErrorKind::kInvalidArgument, "--passthrough takes one number of threads");
  } else if (command.count("--threshold") > 0) {
    throw Error(ErrorKind::kInvalidArgument, "--threshold is for --compare");
  }
}

void run(const CLI::App& command, const BenchArguments& arguments) {
  check_arguments(command, arguments);
  check_outputs(arguments);
  if (!arguments.compare.empty()) {
    const bench::Result before = read_result(arguments.compare[0]);
    const bench::Result after = read_result(arguments.compare[1]);
    write_text("-", bench::comparison_text(before, after, arguments.threshold / 100));
  } else if (!arguments.passthrough.empty()) {
    const int threads = arguments.threads.back();
    const double seconds = bench::pass_through(arguments.clips.front(), arguments.passthrough,
                                               write_options(arguments.encoding, {}, threads), threads);
    write_text("-", fmt::format("{}\n", seconds));
  } else {
    measure(arguments);
  }
}

void add_work(CLI::App& command, BenchArguments& arguments) {
  command
      .add_option("CLIPS", arguments.clips,
                  "Videos, or names of clips that are drawn for it: static, pan, cuts,\n"
                  "cartoon, noise; none: all of these")
      ->type_name("");
  command
      .add_option("--size", arguments.sizes,
                  "Sizes to bring the clips to, before the clock starts; without, files stay\n"
                  "as they are, and drawn clips are 352x288,640x360,1280x720 if no clip is\n"
                  "named and 640x360 else")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("WxH,...");
  command.add_option("--frames", arguments.frames, "Only the first N frames; of drawn clips 60 if not given")
      ->check(CLI::Range(1, 1000000).description(""))
      ->type_name("N");
  command.add_option("--threads", arguments.threads, "A run with each of these numbers of threads")
      ->check(CLI::Range(1, 1024).description(""))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("N,...")
      ->capture_default_str();
  command.add_option("--preset", arguments.presets, "Presets of vectorize")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...")
      ->capture_default_str();
  command.add_option("--max-control-points", arguments.max_control_points, "As of transcode")
      ->type_name("N|P%");
  command
      .add_option("--transcode-options", arguments.transcode_options,
                  "Further options of transcode, in one argument, such as\n'--temporal-weight 0 --rounds 2'")
      ->type_name("TEXT");
  add_video_output_options(command, arguments.encoding);
}

void add_reports(CLI::App& command, BenchArguments& arguments) {
  command.add_option("--json", arguments.json, "Write all figures, with machine, compiler and commit")
      ->type_name("FILE");
  command.add_flag("--markdown", arguments.markdown, "Print tables in Markdown");
  command
      .add_option("--compare", arguments.compare,
                  "Measure nothing: print ratios of two files of --json, with a '*' where\nthey differ")
      ->expected(2)
      ->type_name("BEFORE AFTER");
  command.add_option("--threshold", arguments.threshold, "Of --compare, in percent; PSNR: always 0.2 dB")
      ->check(within(0, 1000))
      ->type_name("P")
      ->capture_default_str();
  command
      .add_option("--passthrough", arguments.passthrough,
                  "Only decode one clip, encode it into this file, and print the seconds")
      ->type_name("FILE");
}

constexpr const char* kBenchFooter = R"(
Each run is a process of its own, 'knotreel transcode', and beside it the same clip is only decoded and
encoded: that is the ceiling. docs/benchmarks.md tells what the figures mean.
Examples:
  knotreel bench --json now.json
  knotreel bench clip.mp4 other.webm --size 640x360,352x288 --frames 100 --markdown
  knotreel bench static pan --preset fast,balanced
  knotreel bench --compare before.json now.json --threshold 5)";

}  // namespace

void add_bench_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("bench", "Measure speed, memory and quality on clips");
  const auto arguments = std::make_shared<BenchArguments>();
  add_work(*command, *arguments);
  add_reports(*command, *arguments);
  command->footer(kBenchFooter);
  command->callback([command, arguments] { run(*command, *arguments); });
}

}  // namespace knotreel::cli
