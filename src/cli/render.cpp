// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>
#include <vector>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/file_names.h"
#include "cli/output_size.h"
#include "cli/parse.h"
#include "cli/pictures.h"
#include "cli/render_video.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/format.h"

namespace knotreel::cli {
namespace {

constexpr std::uint64_t kMaxOutputPixels = std::uint64_t{1} << 32;
constexpr std::uint64_t kMaxTurnedPixels = std::uint64_t{1} << 28;

[[noreturn]] void refuse_rendering(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

/// Size and crop, checked before anything is allocated for them.
raster::RenderOptions render_options(const RenderArguments& arguments, const document::SequenceInfo& info,
                                     const Turn& turn) {
  const Size whole = output_size(arguments.scale, arguments.size, info.width, info.height, turn);
  raster::RenderOptions options;
  options.width = whole.width;
  options.height = whole.height;
  options.antialias = !arguments.aliased;
  Size output = whole;
  if (!arguments.crop.empty()) {
    const Rect crop = parse_crop(arguments.crop, whole, turn);
    options.crop_x = crop.x;
    options.crop_y = crop.y;
    options.crop_width = crop.width;
    options.crop_height = crop.height;
    output = {crop.width, crop.height};
  }
  if (std::uint64_t(output.width) * std::uint64_t(output.height) > kMaxOutputPixels) {
    refuse_rendering("the output would have more than " + std::to_string(kMaxOutputPixels) +
                     " pixels; use --crop");
  }
  return options;
}

/// The last row may come first, so the whole picture is held in memory.
void write_turned(const raster::Renderer& renderer, const Turn& turn, const image::Background& background,
                  image::RowWriter& writer) {
  if (std::uint64_t(renderer.width()) * std::uint64_t(renderer.height()) > kMaxTurnedPixels) {
    refuse_rendering("a video that is shown turned cannot give more than " +
                     std::to_string(kMaxTurnedPixels) + " pixels; use --crop");
  }
  const image::Image whole = image::on_background(video::turned(renderer.whole(), turn), background);
  writer.write(whole.samples, whole.height);
}

image::ImageFormat format_of_picture(const RenderArguments& arguments) {
  if (!arguments.format.empty()) return *image::format_of_extension(arguments.format);
  const std::string extension = std::filesystem::path(arguments.output).extension().string();
  const auto named = image::format_of_extension(extension.empty() ? extension : extension.substr(1));
  return named.value_or(image::ImageFormat::kPng);
}

/// Of the picture, but for its size and channels.
image::ImageFileSpec picture_spec(const RenderArguments& arguments) {
  image::ImageFileSpec spec;
  spec.samples = samples_of(arguments).value_or(image::default_samples(format_of_picture(arguments)));
  if (arguments.format.empty()) return spec;
  spec.format = image::format_of_extension(arguments.format);
  spec.file_channels = image::channels_of_extension(arguments.format);
  return spec;
}

void render_picture(const RenderArguments& arguments, document::Reader& reader, bool frame_is_told) {
  const image::Background background = parse_background(arguments.background);
  const Turn turn = turn_of(reader);
  const raster::RenderOptions options = render_options(arguments, reader.info(), turn);
  const raster::Renderer renderer(read_frame(reader, arguments.frame), options);
  image::ImageFileSpec spec = picture_spec(arguments);
  spec.width = turn.swaps_sides() ? renderer.height() : renderer.width();
  spec.height = turn.swaps_sides() ? renderer.width() : renderer.height();
  spec.channels = image::channels_on(background, renderer.channels());
  const auto writer = image::open_image_writer(arguments.output, spec);
  warn_of_other_frames(arguments.input, reader, frame_is_told);
  if (turn.is_none()) {
    stream_rendering(renderer, background, *writer);
  } else {
    write_turned(renderer, turn, background, *writer);
  }
  writer->finish();
}

/// Options that would be without effect are refused: a picture of another frame looks right.
void check_rendering_kind(const CLI::App& command, bool video) {
  if (video && command.count("--frame") > 0)
    refuse_rendering("--frame is for one picture; use --frames for a video");
  if (video) return;
  for (const std::string& name : options_given(command, kVideoGroup)) {
    refuse_rendering(name + " is for videos and numbered pictures" +
                     (name == "--frames" || name == "--start" ? "; use --frame for one picture"
                                                              : ", not for one picture"));
  }
}

/// Everything that can be told before the document is read.
void check_arguments(const CLI::App& command, const RenderArguments& arguments, bool video) {
  const std::vector<Output> outputs = outputs_of(arguments);
  check_rendering_kind(command, video);
  if (arguments.format.empty()) check_rendering_name(arguments.output, "copy");
  check_output_size(arguments.scale, arguments.size);
  if (!arguments.crop.empty()) parse_rect("--crop", arguments.crop);
  parse_background(arguments.background);
  if (video) {
    check_video(arguments);
  } else if (!arguments.format.empty() && !image::format_of_extension(arguments.format)) {
    refuse_rendering("--format does not know '" + arguments.format + "' for one picture");
  }
  check_paths({arguments.input, arguments.copied}, outputs);
}

/// Names end as those of single pictures do, so that --format has to say it; and it may be one all the same.
bool may_be_animated(const RenderArguments& arguments) {
  return image::format_of_extension(arguments.format) == image::ImageFormat::kWebp;
}

void render(const CLI::App& command, RenderArguments& arguments) {
  const std::string named = arguments.output;
  if (arguments.format == "null") arguments.output = "null";
  if (arguments.output.empty()) {
    if (arguments.format != "hash") refuse_rendering("--output is required (see knotreel render --help)");
    arguments.output = "-";  // for the digest
  }
  const bool frame_is_told = command.count("--frame") > 0;
  const bool animation = may_be_animated(arguments) && !frame_is_told;
  bool video = is_video_output(arguments.output, arguments.format) ||
               (animation && !options_given(command, kVideoGroup).empty());
  check_arguments(command, arguments, video);
  warn_if_not_written(named, arguments.format);
  const ThreadCap cap(arguments.threads);
  document::Reader reader = open_document(arguments.input);
  if (animation && !video && reader.frame_count() > 1) {
    check_video(arguments);
    video = true;
  }
  if (video) {
    render_video(arguments, reader);
  } else {
    render_picture(arguments, reader, frame_is_told);
  }
}

constexpr const char* kRenderFooter = R"(
Memory does not grow with the size of the output, except for TIFF, JPEG, WebP and BMP, and for frames of
videos that players show turned. --size and --crop are of what is shown.
If the output is a video (clip.mp4, or clip.webp with --format webp) or a pattern (frame_%04d.png), all
frames are drawn, at their times.
Examples:
  knotreel render photo.tcb -o photo.png
  knotreel render photo.tcb -o print.png --scale 16 --depth 16
  knotreel render photo.tcb -o detail.png --scale 8 --crop 800,400,640,360
  knotreel render clip.tcb -o clip.mp4 --scale 2
  knotreel render photo.tcb -o - --format ppm --size 1920x1080 | other-program)";

}  // namespace

void add_render_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("render", "Draw a vector document as a picture or a video of any size");
  const auto arguments = std::make_shared<RenderArguments>();
  command->add_option("FILE", arguments->input, "Vector document (.tcb); '-': standard input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Picture or video to write; its name says the format: png, ppm, pgm, pam,\n"
                   "pfm, tiff, jpg, webp, bmp, or a video. '-': standard output")
      ->type_name("FILE");
  auto* scale = command->add_option("--scale", arguments->scale, "Output pixels per picture pixel, above 0")
                    ->type_name("S")
                    ->capture_default_str();
  command
      ->add_option("--size", arguments->size,
                   "Size of the whole picture in output pixels, up to 1000000\non a side")
      ->type_name("WxH")
      ->excludes(scale);
  command->add_option("--crop", arguments->crop, "Part to draw, in output pixels from the top left corner")
      ->type_name("X,Y,W,H");
  add_frame_option(*command, arguments->frame, "Frame of a sequence, counted from 0");
  command
      ->add_option(
          "--depth", arguments->depth,
          "Bits per sample: 8 (all but pfm), 16 (png, ppm, pam, tiff) or\nfloat (pfm, tiff). Without: 8, or "
          "float in pfm; of videos and\nnumbered pictures as many as the source had, if they can be")
      ->check(CLI::IsMember({"8", "16", "float"}).description(""))
      ->type_name("N");
  add_background_option(*command, arguments->background);
  command
      ->add_option(
          "-f,--format", arguments->format,
          "Format if the name does not say it; for '-' it is png if not given.\nnull: none is written; hash: "
          "print a digest of all frames and times")
      ->type_name("NAME");
  command->add_flag("--no-antialias", arguments->aliased, "Leave the edges of features jagged");
  add_threads_option(*command, arguments->threads);
  add_no_overwrite_option(*command);
  add_quiet_option(*command);
  add_render_video_options(*command, *arguments);
  command->footer(kRenderFooter);
  command->callback([command, arguments] { render(*command, *arguments); });
}

}  // namespace knotreel::cli
