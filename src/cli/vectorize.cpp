// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "cli/command.h"
#include "cli/debug/debug_pictures.h"
#include "cli/distinct_paths.h"
#include "cli/drawing_file.h"
#include "cli/file_names.h"
#include "cli/interrupt.h"
#include "cli/metrics_report.h"
#include "cli/pictures.h"
#include "cli/printable.h"
#include "cli/progress_line.h"
#include "cli/stats.h"
#include "cli/still_document.h"
#include "cli/vectorize_options.h"
#include "cli/vectorize_video.h"
#include "knotreel/base/output_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/metrics.h"
#include "knotreel/image/read_image.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::cli {
namespace {

struct VectorizeArguments {
  std::string input;
  std::string output;
  VectorizeOptions options;
  std::string stats;
  std::string debug_dir;
  int threads = 0;
  VideoRun video;  ///< what only matters for videos
};

/// Debug pictures, if any are wanted, on a clock of their own.
class Watcher {
 public:
  Watcher(const std::string& folder, StageTimer& timer) : timer_(timer) {
    if (!folder.empty()) pictures_.emplace(folder);
  }

  void see(const vectorize::Progress& progress) {
    draw([&] { pictures_->write(progress); });
  }
  void see_stored(const image::Image& image, const document::FrameModel& model) {
    draw([&] { pictures_->write_control_net(image, model); });
  }

 private:
  template <class Draw>
  void draw(Draw&& draw) {
    if (!pictures_) return;
    StageTimer drawing;
    draw();
    timer_.attribute("debug", drawing.running());
  }

  std::optional<debug::DebugPictures> pictures_;
  StageTimer& timer_;
};

vectorize::Vectorization run(const image::Image& image, const vectorize::Options& options, Watcher& watcher) {
  ProgressLine line;
  return vectorize::vectorize_picture(image, options, [&](const vectorize::Progress& progress) {
    check_interrupted();
    line.show(progress.stage);
    watcher.see(progress);
    check_interrupted();
  });
}

std::vector<Output> outputs_of(const VectorizeArguments& arguments) {
  std::vector<Output> outputs{{arguments.output}, {arguments.stats}};
  if (!arguments.debug_dir.empty()) {
    outputs.push_back({(std::filesystem::path(arguments.debug_dir) / "[0-9][0-9]-*.png").string(), true});
  }
  return outputs;
}

/// Opened before the work, since it is better to fail then than after it; and once, since the reader of a
/// pipe takes the first end for the only one.
struct OutputFiles {
  explicit OutputFiles(const VectorizeArguments& arguments) : document(arguments.output) {
    if (!arguments.stats.empty()) stats.emplace(arguments.stats);
  }
  OutputFile document;
  std::optional<OutputFile> stats;
};

/// All that docs/stats.md promises.
nlohmann::ordered_json stats_json(const VectorizeArguments& arguments, const image::Image& image,
                                  const vectorize::Options& options, const vectorize::Report& report,
                                  const StillDocument& document, std::uint64_t file_bytes,
                                  const image::ImageMetrics& metrics) {
  const auto& space = *document.model.space;
  nlohmann::ordered_json stats{{"version", KNOTREEL_VERSION},
                               {"input", arguments.input},
                               {"output", arguments.output},
                               {"width", image.width},
                               {"height", image.height},
                               {"channels", image.channels},
                               {"preset", arguments.options.preset},
                               {"threads", arguments.threads},
                               {"options", options_json(options)},
                               {"features", features_json(report)},
                               {"rounds", rounds_json(report)},
                               {"knots", space.mesh().knots.size()},
                               {"triangles", space.mesh().faces.size()},
                               {"feature_segments", space.mesh().segments.size()},
                               {"control_points", space.function_count()},
                               {"edge_softness", document.model.edge_softness},
                               {"raw_accounting_bytes", document::raw_accounting_bytes(document.model)},
                               {"file_bytes", file_bytes}};
  stats.update(metrics_json(metrics));
  return stats;
}

void vectorize_picture(const VectorizeArguments& arguments) {
  check_paths({arguments.input}, outputs_of(arguments));
  const std::string drawing = drawing_format(arguments.output);
  if (drawing.empty()) check_document_name(arguments.output);
  const ThreadCap cap(arguments.threads);
  StageTimer timer;
  image::ImageFileInfo source;
  const image::Image image = read_source(arguments.input, &source);
  if (source.colour_profile) {
    warn(fmt::format("{} has a colour profile, which is not applied: colours are taken as they are stored",
                     arguments.input));
  }
  if (source.more_pages) warn(fmt::format("{} has more pages; the first is read", arguments.input));
  vectorize::Options options = effective_options(arguments.options, image.pixel_count());
  OutputFiles files(arguments);
  Watcher watcher(arguments.debug_dir, timer);
  timer.finish("decode");

  const vectorize::Vectorization made = run(image, options, watcher);
  check_interrupted();
  options.max_control_points = made.report.max_control_points;
  warn_of(arguments.input, warnings_of(made.report));
  if (arguments.options.fine_grid == "all" && image.pixel_count() > vectorize::kMostFineGridPixels)
    warn(fmt::format("{} has more than {} pixels: no --fine-grid", arguments.input,
                     vectorize::kMostFineGridPixels));
  timer.finish("vectorize");

  const StillDocument document = still_document(image, made.model);
  if (drawing.empty()) {
    files.document.write(document.bytes);
  } else {
    write_drawing(document.model, drawing_options(drawing), drawing, files.document);
  }
  files.document.commit();
  warn_if_large(files.document.size(), drawing);
  timer.finish("write");

  const image::ImageMetrics metrics = image::compare_images(image, render_whole(document.model, {}));
  timer.finish("measure");
  watcher.see_stored(image, document.model);

  if (files.stats) {
    auto stats = stats_json(arguments, image, options, made.report, document, files.document.size(), metrics);
    stats["seconds"] = timer.seconds();
    files.stats->write(stats.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    files.stats->commit();
  }
  if (!uses_standard_output(outputs_of(arguments))) {
    const auto& space = *document.model.space;
    tell_result(fmt::format("{}: {} knots, {} control points, {} bytes, PSNR {}\n",
                            printable(arguments.output), space.mesh().knots.size(), space.function_count(),
                            files.document.size(), psnr_text(metrics.psnr)));
  }
}

void vectorize(const CLI::App& command, const VectorizeArguments& arguments) {
  const bool split = !arguments.video.split_folder.empty();
  if (arguments.output.empty() && !split) {
    throw Error(ErrorKind::kInvalidArgument, "--output is required (see knotreel vectorize --help)");
  }
  if (split || is_video(arguments.input, arguments.video.reading)) {
    VideoRun run = arguments.video;
    run.input = arguments.input;
    run.document = arguments.output;
    run.options = arguments.options;
    run.stats = arguments.stats;
    run.debug_dir = arguments.debug_dir;
    run.threads = arguments.threads;
    vectorize_video(std::move(run));
  } else {
    for (const std::string& name : options_given(command, kVideoGroup))
      warn(name + " is not used: '" + arguments.input + "' is one picture");
    vectorize_picture(arguments);
  }
}

constexpr const char* kVectorizeFooter = R"(
Features (sharp edges) become curves at which the colours may jump; between them the surface is smooth.
Knots go where the picture needs them, first at once and then in rounds. The figures printed are those
of the document as stored. The same picture and options give the same file.
A video, a folder of pictures or a pattern such as in_%04d.png becomes a document with all frames, each made
from the frame before. After Ctrl-C it holds what was done.
Examples:
  knotreel vectorize photo.png -o photo.tcb
  knotreel vectorize photo.png -o fine.tcb --preset fine --max-control-points 5%
  knotreel vectorize scan.tiff -o scan.tcb --degree 3 --edge-threshold 20 --stats scan.json
  knotreel vectorize clip.mp4 -o clip.tcb
  knotreel vectorize logo.png -o logo.svg
  knotreel vectorize logo.png -o logo.tcb --debug-dir logo-stages)";

}  // namespace

void add_vectorize_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("vectorize", "Turn a picture or a video into a vector document");
  const auto arguments = std::make_shared<VectorizeArguments>();
  command->add_option("INPUT", arguments->input, "Picture or video to read; '-': standard input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Vector document to write (.tcb), or one picture as .svg or .pdf;\n'-': standard output")
      ->type_name("FILE");
  add_vectorize_options(*command, arguments->options, kBoundOfPicturesAndVideos);
  command
      ->add_option("--stats", arguments->stats,
                   "Write options, counts, quality and time of every round as JSON;\n'-': standard output")
      ->type_name("FILE");
  command
      ->add_option("--debug-dir", arguments->debug_dir,
                   "Write PNG pictures of every stage into this folder, made if missing;\n"
                   "of a video, into a folder for each frame")
      ->type_name("DIR");
  add_threads_option(*command, arguments->threads);
  add_no_overwrite_option(*command);
  add_quiet_option(*command);
  add_vectorize_video_options(*command, arguments->video);
  command->footer(kVectorizeFooter);
  command->callback([command, arguments] { vectorize(*command, *arguments); });
}

}  // namespace knotreel::cli
