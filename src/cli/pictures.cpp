#include "cli/pictures.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cli/interrupt.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/read_image.h"

namespace knotreel::cli {
namespace {

/// Of a document from standard input; it has to be held in memory.
constexpr std::uint64_t kMaxPipedBytes = std::uint64_t{1} << 32;

/// Rows handed over at once: about a million pixels.
int band_rows(int width) {
  return std::max(1, (1 << 20) / width);
}

/// In place; the result is tightly packed at the front.
void put_on_background(std::vector<float>& samples, int channels, const std::array<float, 3>& background) {
  const auto stride = static_cast<std::size_t>(channels);
  const std::size_t colours = stride - 1;
  const float grey = 0.299F * background[0] + 0.587F * background[1] + 0.114F * background[2];
  std::size_t to = 0;
  for (std::size_t from = 0; from < samples.size(); from += stride) {
    const float alpha = std::clamp(samples[from + colours] / 255.0F, 0.0F, 1.0F);
    for (std::size_t c = 0; c < colours; ++c) {
      const float behind = colours == 1 ? grey : background[c];
      samples[to++] = alpha * samples[from + c] + (1 - alpha) * behind;
    }
  }
  samples.resize(to);
}

struct Band {
  int rows = 0;
  std::vector<float> samples;
};

}  // namespace

bool is_picture(const std::filesystem::path& path) {
  if (path == "-" || image::detect_format(read_start(path, 16))) return true;
  const std::string extension = path.extension().string();
  return !extension.empty() && image::format_of_extension(extension.substr(1)).has_value();
}

document::Reader open_document(const std::filesystem::path& path) {
  if (path != "-") return document::Reader::open(path);
  return document::Reader::open(read_whole(path, kMaxPipedBytes, "document"), "standard input");
}

document::FrameModel read_frame(document::Reader& reader, std::uint64_t frame) {
  if (frame >= reader.frame_count()) {
    throw Error(ErrorKind::kInvalidArgument, "there is no frame " + std::to_string(frame) +
                                                 ": the document has " +
                                                 std::to_string(reader.frame_count()) + ", counted from 0");
  }
  return reader.read(frame);
}

int channels_on(const Background& background, int channels) {
  return background && channels % 2 == 0 ? channels - 1 : channels;
}

void stream_rendering(const raster::Renderer& renderer, const Background& background,
                      image::RowWriter& writer) {
  const std::size_t row_size = std::size_t(renderer.width()) * std::size_t(renderer.channels());
  const bool flatten = channels_on(background, renderer.channels()) != renderer.channels();
  Band ready;  // rendered, not yet written
  Band next;
  for (int top = 0; top < renderer.height() || ready.rows > 0;) {
    check_interrupted();
    next.rows = std::min(band_rows(renderer.width()), renderer.height() - top);
    next.samples.resize(std::size_t(next.rows) * row_size);
    parallel_for(2, [&](std::size_t task) {
      if (task == 0) {
        renderer.rows(top, top + next.rows, next.samples);
      } else {
        if (flatten) put_on_background(ready.samples, renderer.channels(), *background);
        writer.write(ready.samples, ready.rows);
      }
    });
    top += next.rows;
    std::swap(ready, next);
  }
  check_interrupted();
}

image::Image render_whole(const document::FrameModel& model, const raster::RenderOptions& options) {
  const raster::Renderer renderer(model, options);
  image::Image image = image::make_image(renderer.width(), renderer.height(), renderer.channels());
  renderer.rows(0, image.height, image.samples);
  return image;
}

image::Image load_picture(const std::filesystem::path& path, std::uint64_t frame) {
  if (is_picture(path)) return image::read_image(path);
  document::Reader reader = open_document(path);
  return render_whole(read_frame(reader, frame), {});
}

}  // namespace knotreel::cli
