#include "cli/batch/picture_job.h"

#include <filesystem>
#include <sstream>

#include "cli/interrupt.h"
#include "cli/pictures.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"
#include "knotreel/document/writer.h"
#include "knotreel/image/metrics.h"
#include "knotreel/image/read_image.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::cli::batch {
namespace {

void make_folder_of(const std::string& path) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) {
    throw Error(ErrorKind::kOutput, "cannot make folder '" + folder.string() + "': " + error.message());
  }
}

/// Writes the document. @return the frame as it was stored
document::FrameModel write_document(OutputFile& file, const image::Image& image,
                                    const document::FrameModel& model) {
  document::SequenceInfo info;
  info.width = image.width;
  info.height = image.height;
  info.channels = image.channels;
  info.degree = model.space->degree();
  std::ostringstream bytes;
  document::Writer writer(bytes, info, {.rename_knots = true});
  document::FrameModel stored = writer.append(model);
  writer.finish();
  file.write(std::move(bytes).str());
  return stored;
}

}  // namespace

Figures PictureJob::run(const Item& item, Room& room) const {
  check_interrupted();
  const image::Image image = image::read_image(item.input);
  make_folder_of(item.output);
  const vectorize::Options options = effective_options(options_, image.pixel_count());
  const Room::Stay stay = room.enter(double(image.pixel_count()) > alone_above_);
  check_interrupted();
  OutputFile file(item.output);  // first: better to fail before the work
  const vectorize::Vectorization made =
      vectorize::vectorize_picture(image, options, [](const vectorize::Progress&) { check_interrupted(); });
  check_interrupted();
  const document::FrameModel stored = write_document(file, image, made.model);
  file.commit();
  const double psnr = image::compare_images(image, render_whole(stored, {})).psnr;
  return {stored.space->mesh().knots.size(), stored.space->function_count(), psnr, file.size()};
}

}  // namespace knotreel::cli::batch
