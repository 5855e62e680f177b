// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/picture_job.h"

#include <filesystem>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "cli/still_document.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"
#include "knotreel/image/metrics.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::cli::batch {

void make_folder_of(const std::string& path) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error(ErrorKind::kOutput, "cannot make folder '" + folder.string() + "': " + error.message());
  }
}

Figures PictureJob::run(const Item& item, Room& room) const {
  check_interrupted();
  const image::Image image = read_source(item.input);
  make_folder_of(item.output);
  const vectorize::Options options = effective_options(options_, image.pixel_count());
  const Room::Stay stay = room.enter(double(image.pixel_count()) > alone_above_);
  check_interrupted();
  OutputFile file(item.output);  // first: better to fail before the work
  const vectorize::Vectorization made =
      vectorize::vectorize_picture(image, options, [](const vectorize::Progress&) { check_interrupted(); });
  check_interrupted();
  warn_of(item.input, warnings_of(made.report));
  const StillDocument document = still_document(image, made.model);
  file.write(document.bytes);
  file.commit();
  const document::FrameModel& stored = document.model;
  const double psnr = image::compare_images(image, render_whole(stored, {})).psnr;
  return {stored.space->mesh().knots.size(), stored.space->function_count(), psnr, file.size(), 1};
}

}  // namespace knotreel::cli::batch
