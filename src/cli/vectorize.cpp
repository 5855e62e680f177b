#include <fmt/core.h>

#include <chrono>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/metrics_report.h"
#include "cli/parse.h"
#include "cli/pictures.h"
#include "knotreel/base/output_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/document/writer.h"
#include "knotreel/fit/uniform_fit.h"
#include "knotreel/image/metrics.h"
#include "knotreel/image/read_image.h"

namespace knotreel::cli {
namespace {

struct Arguments {
  std::string input;
  std::string output;
  std::string control_points = "2%";
  int degree = 2;
  std::uint64_t seed = 1;
  bool smooth_corners = true;
  std::string stats;
  int threads = 0;
};

/// Seconds spent in each stage, in order.
class StageTimer {
 public:
  void finish(const std::string& stage) {
    const auto now = Clock::now();
    seconds_[stage] = std::chrono::duration<double>(now - start_).count();
    start_ = now;
  }
  const nlohmann::ordered_json& seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  nlohmann::ordered_json seconds_ = nlohmann::ordered_json::object();
};

/// A document of one frame in memory, and that frame as it was stored, that is quantised.
struct Stored {
  std::string bytes;
  document::FrameModel model;
};

Stored encode(const image::Image& image, const document::FrameModel& model) {
  document::SequenceInfo info;
  info.width = image.width;
  info.height = image.height;
  info.channels = image.channels;
  info.degree = model.space->degree();
  std::ostringstream bytes;
  document::Writer writer(bytes, info, {.rename_knots = true});
  document::FrameModel stored = writer.append(model);
  writer.finish();
  return {std::move(bytes).str(), std::move(stored)};
}

void vectorize(const Arguments& arguments) {
  const ThreadCap cap(arguments.threads);
  StageTimer timer;
  const image::Image image = image::read_image(arguments.input);
  { const OutputFile probe(arguments.output); }  // better to fail now than after the fit
  timer.finish("decode");

  fit::UniformFitOptions options;
  options.control_points = parse_count("--control-points", arguments.control_points, image.pixel_count());
  options.degree = arguments.degree;
  options.seed = arguments.seed;
  options.colour.smooth_corners = arguments.smooth_corners;
  const document::FrameModel fitted = fit::fit_uniform(image, options);
  check_interrupted();
  timer.finish("fit");

  const Stored document = encode(image, fitted);
  OutputFile file(arguments.output);
  file.write(document.bytes);
  file.commit();
  timer.finish("write");

  const document::FrameModel& stored = document.model;
  const image::ImageMetrics metrics = image::compare_images(image, render_whole(stored, {}));
  timer.finish("measure");

  const auto& space = *stored.space;
  if (!arguments.stats.empty()) {
    nlohmann::ordered_json stats{{"input", arguments.input},
                                 {"output", arguments.output},
                                 {"width", image.width},
                                 {"height", image.height},
                                 {"channels", image.channels},
                                 {"degree", space.degree()},
                                 {"seed", arguments.seed},
                                 {"smooth_corners", arguments.smooth_corners},
                                 {"threads", arguments.threads},
                                 {"knots", space.mesh().knots.size()},
                                 {"triangles", space.mesh().faces.size()},
                                 {"control_points", space.function_count()},
                                 {"raw_accounting_bytes", document::raw_accounting_bytes(stored)},
                                 {"file_bytes", document.bytes.size()}};
    stats.update(metrics_json(metrics));
    stats["seconds"] = timer.seconds();
    write_text(arguments.stats,
               stats.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }
  if (arguments.stats != "-" && arguments.output != "-") {
    write_text("-", fmt::format("{}: {} knots, {} control points, {} bytes, PSNR {}\n", arguments.output,
                                space.mesh().knots.size(), space.function_count(), document.bytes.size(),
                                psnr_text(metrics.psnr)));
  }
}

constexpr const char* kFooter = R"(
The knots are spread evenly over the picture and the colours fitted by least squares; the figures
printed are those of the document as stored. The same input and options give the same file.
Examples:
  knotreel vectorize photo.png -o photo.tcb
  knotreel vectorize photo.png -o fine.tcb --control-points 5%
  knotreel vectorize scan.tiff -o scan.tcb --control-points 20000 --degree 3 --stats scan.json)";

}  // namespace

void add_vectorize_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("vectorize", "Turn a picture into a vector document");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("PICTURE", arguments->input, "Picture to read; '-': standard input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output, "Vector document to write (.tcb); '-': standard output")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--control-points", arguments->control_points,
                   "About how many control points: a number, or a share of the pixels\nsuch as 2% (above 0, "
                   "at most 100%)")
      ->type_name("N|P%")
      ->capture_default_str();
  command->add_option("--degree", arguments->degree, "Degree of the splines: 1, 2 or 3")
      ->check(CLI::Range(1, 3).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Start of the random numbers that break ties")
      ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag_callback(
      "--no-smooth-corners", [arguments] { arguments->smooth_corners = false; },
      "Leave the surface merely continuous, not smooth, along the edges of the\nknot "
      "mesh that run into corners of the picture");
  command
      ->add_option("--stats", arguments->stats,
                   "Write counts, quality and seconds per stage as JSON; '-': standard output")
      ->type_name("FILE");
  add_threads_option(*command, arguments->threads);
  command->footer(kFooter);
  command->callback([arguments] { vectorize(*arguments); });
}

}  // namespace knotreel::cli
