// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/compare_videos.h"
#include "cli/distinct_paths.h"
#include "cli/frame_source.h"
#include "cli/metrics_report.h"
#include "cli/pictures.h"
#include "cli/video_options.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::cli {
namespace {

struct CompareArguments {
  std::string a;
  std::string b;
  std::uint64_t frame = 0;
  bool one_frame = false;     ///< --frame was given
  bool deinterlaces = false;  ///< --deinterlace was given
  std::string deinterlace = "auto";
  std::string filter;
  std::string stats;
  bool json = false;
  int threads = 0;
};

void compare_pictures(const CompareArguments& arguments) {
  const ThreadCap cap(arguments.threads);
  const std::optional<std::uint64_t> frame =
      arguments.one_frame ? std::optional(arguments.frame) : std::nullopt;
  const image::Image a = load_picture(arguments.a, frame);
  const image::Image b = load_picture(arguments.b, frame);
  const image::ImageMetrics metrics = image::compare_images(a, b);
  if (arguments.json) {
    nlohmann::ordered_json json{{"width", a.width}, {"height", a.height}};
    json.update(metrics_json(metrics));
    write_text("-", json.dump(2) + "\n");
    return;
  }
  write_text(
      "-", fmt::format("size  {}x{}\n"
                       "MEC   {:.3f}   mean length of the colour error, 0..255 (0 is equal)\n"
                       "RMSE  {:.5f}   root mean square error, colour in 0..1 (0 is equal)\n"
                       "PSNR  {}   on 8 bits (more is better)\n"
                       "SSIM  {:.5f}   structural similarity (1 is equal)\n",
                       a.width, a.height, metrics.mec, metrics.rmse, psnr_text(metrics.psnr), metrics.ssim));
}

[[noreturn]] void refuse_option(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

/// Options that would be without effect are refused: figures do not show that nothing was done.
void check_stills(const CompareArguments& arguments) {
  if (!arguments.stats.empty()) refuse_option("--stats is for videos");
  if (!arguments.filter.empty()) refuse_option("--filter is for videos");
  if (arguments.deinterlaces) refuse_option("--deinterlace is for videos");
}

void check_reading(const CompareArguments& arguments) {
  const bool draws_a = is_document(arguments.a);
  if (draws_a && !arguments.filter.empty())
    refuse_option("--filter is for the video A, and '" + arguments.a + "' is a document");
  if (draws_a && is_document(arguments.b) && arguments.deinterlaces)
    refuse_option("--deinterlace is for videos, and both are documents");
}

void compare(const CompareArguments& arguments) {
  check_paths({arguments.a, arguments.b}, {{arguments.stats}});
  for (const std::string& path : {arguments.a, arguments.b}) {
    if (arguments.one_frame && !is_document(path) && has_frames(path))
      refuse_option("--frame is for documents, and '" + path + "' is a video");
  }
  const bool videos = !arguments.one_frame && (has_frames(arguments.a) || has_frames(arguments.b));
  if (videos) {
    check_reading(arguments);
    compare_videos({.reference = arguments.a,
                    .result = arguments.b,
                    .deinterlace = arguments.deinterlace,
                    .filter = arguments.filter,
                    .stats = arguments.stats,
                    .json = arguments.json,
                    .threads = arguments.threads});
  } else {
    check_stills(arguments);
    compare_pictures(arguments);
  }
}

constexpr const char* kCompareFooter = R"(
Documents are drawn at their own size. Both must have the same size; grey is compared with
colour as grey in all three channels. In JSON, a psnr of null means equal pictures.
Videos, and documents with several frames, are compared frame by frame, A being the reference for what
flickers in B.
Examples:
  knotreel compare photo.png photo.tcb
  knotreel compare before.png after.png --json
  knotreel compare clip.mp4 clip.tcb --stats frames.json)";

}  // namespace

void add_compare_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "compare", "Measure how far two pictures, videos or documents are apart: MEC, PSNR, SSIM");
  const auto arguments = std::make_shared<CompareArguments>();
  command
      ->add_option("A", arguments->a,
                   "Picture, video or document; '-': picture or document on standard\ninput")
      ->type_name("")
      ->required();
  command->add_option("B", arguments->b, "Picture, video or document")->type_name("")->required();
  add_frame_option(*command, arguments->frame, "Only this frame of documents, counted from 0");
  command
      ->add_option("--stats", arguments->stats,
                   "Write the figures of every frame of videos as JSON; '-': standard output")
      ->type_name("FILE");
  add_deinterlace_option(*command, arguments->deinterlace);
  command
      ->add_option("--filter", arguments->filter,
                   "Filters for the frames of the video A, as ffmpeg -vf takes them: those\n"
                   "that B was made with")
      ->type_name("GRAPH");
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_threads_option(*command, arguments->threads);
  command->footer(kCompareFooter);
  command->callback([arguments, command] {
    arguments->one_frame = command->count("--frame") > 0;
    arguments->deinterlaces = command->count("--deinterlace") > 0;
    compare(*arguments);
  });
}

}  // namespace knotreel::cli
