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

/// Rows rendered by one task and rows handed over at once. They depend on the width alone: were they to
/// depend on the number of threads, a renderer that starts from the neighbouring pixel could show it.
struct Bands {
  explicit Bands(int width)
      : strip(std::clamp((1 << 17) / width, 1, 32)),
        band(std::max(strip, (1 << 20) / width / strip * strip)) {}
  int strip;
  int band;
};

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
  const Bands bands(renderer.width());
  const std::size_t row_size = std::size_t(renderer.width()) * std::size_t(renderer.channels());
  const bool flatten = channels_on(background, renderer.channels()) != renderer.channels();
  Band ready;  // rendered, not yet written
  Band next;
  for (int top = 0; top < renderer.height() || ready.rows > 0;) {
    next.rows = std::min(bands.band, renderer.height() - top);
    next.samples.resize(std::size_t(next.rows) * row_size);
    const int strips = (next.rows + bands.strip - 1) / bands.strip;
    // Task 0 writes the band before, the others render this one.
    parallel_for(std::size_t(strips) + 1, [&](std::size_t task) {
      check_interrupted();
      if (task == 0) {
        if (flatten) put_on_background(ready.samples, renderer.channels(), *background);
        writer.write(ready.samples, ready.rows);
        return;
      }
      const int begin = int(task - 1) * bands.strip;
      const int end = std::min(begin + bands.strip, next.rows);
      renderer.rows(top + begin, top + end,
                    std::span(next.samples)
                        .subspan(std::size_t(begin) * row_size, std::size_t(end - begin) * row_size));
    });
    top += next.rows;
    std::swap(ready, next);
  }
  check_interrupted();
}

image::Image render_whole(const document::FrameModel& model, const raster::RenderOptions& options) {
  class Collector final : public image::RowWriter {
   public:
    explicit Collector(image::Image& image) : image_(image) {}
    void write(std::span<const float> rows, int) override {
      image_.samples.insert(image_.samples.end(), rows.begin(), rows.end());
    }
    void finish() override {}

   private:
    image::Image& image_;
  };
  const raster::Renderer renderer(model, options);
  image::Image image{renderer.width(), renderer.height(), renderer.channels(), {}};
  image.samples.reserve(image.row_size() * std::size_t(image.height));
  Collector collector(image);
  stream_rendering(renderer, std::nullopt, collector);
  return image;
}

image::Image load_picture(const std::filesystem::path& path, std::uint64_t frame) {
  if (is_picture(path)) return image::read_image(path);
  document::Reader reader = document::Reader::open(path);
  return render_whole(read_frame(reader, frame), {});
}

}  // namespace knotreel::cli
