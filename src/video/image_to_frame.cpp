#include "image_to_frame.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "colour_rules.h"
#include "knotreel/base/parallel.h"

namespace knotreel::video {
namespace {

/// Everything that a row of the target needs to know.
struct Job {
  const image::Image& image;
  AVFrame& frame;
  const AVPixFmtDescriptor& format;
  LumaWeights weights;
  ChromaPlace place;
  bool full;
};

float sample(const image::Image& image, int x, int y, int colour) {
  return image.at(x, y, image.colour_channels() == 1 ? 0 : colour);
}

float luma(const Job& job, int x, int y) {
  if (job.image.colour_channels() == 1) return job.image.at(x, y, 0);
  return job.weights.red * job.image.at(x, y, 0) + job.weights.green() * job.image.at(x, y, 1) +
         job.weights.blue * job.image.at(x, y, 2);
}

/// Weights of the pixels first, first + 1, ... along one axis, for a chroma sample of a cell of pixels.
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

Taps taps(int cell, double place) {
  if (cell == 2 && place != 0.5) return {place == 0 ? -1 : 0, {0.25F, 0.5F, 0.25F}};
  return {0, std::vector<float>(std::size_t(cell), 1.0F / float(cell))};
}

/// Adds the chroma of a row of pixels, on the scale -127.5..127.5, times a weight. which: 1 blue, 2 red.
void add_chroma(const Job& job, int row, int which, float weight, std::vector<float>& sums) {
  const float to_chroma = weight / (2 * (1 - (which == 1 ? job.weights.blue : job.weights.red)));
  for (int x = 0; x < job.image.width; ++x)
    sums[std::size_t(x)] += to_chroma * (job.image.at(x, row, which == 1 ? 2 : 0) - luma(job, x, row));
}

std::uint32_t stored(const Job& job, int component, float value, float factor, float offset) {
  const int depth = job.format.comp[component].depth;
  const double most = double((std::int64_t{1} << depth) - 1);
  const double exact = double(value) * double(factor) + double(offset);
  return std::uint32_t(std::clamp(exact + 0.5, 0.0, most));
}

void put_line(const Job& job, int component, int y, const std::vector<std::uint32_t>& line) {
  av_write_image_line2(line.data(), job.frame.data, job.frame.linesize, &job.format, 0, y, component,
                       int(line.size()), 4);
}

/// A component with a value(x, y) for every pixel: all but chroma.
template <class Value>
void put_component(const Job& job, int component, bool limited, const Value& value) {
  const int depth = job.format.comp[component].depth;
  const float step = limited ? float(1 << (depth - 8)) : float((std::int64_t{1} << depth) - 1) / 255.0F;
  const float factor = limited ? step * 219.0F / 255.0F : step;
  const float offset = limited ? 16 * step : 0;
  parallel_for(std::size_t(job.image.height), [&](std::size_t row) {
    std::vector<std::uint32_t> line(std::size_t(job.image.width));
    for (int x = 0; x < job.image.width; ++x) {
      line[std::size_t(x)] = stored(job, component, value(x, int(row)), factor, offset);
    }
    put_line(job, component, int(row), line);
  });
}

void put_chroma(const Job& job, int component) {
  const int depth = job.format.comp[component].depth;
  const float step = float(1 << (depth - 8));
  const float factor = job.full ? float((1 << depth) - 1) / 255.0F : step * 224.0F / 255.0F;
  const int across = job.format.log2_chroma_w, down = job.format.log2_chroma_h;
  const Taps taps_across = taps(1 << across, job.place.x), taps_down = taps(1 << down, job.place.y);
  const int columns = AV_CEIL_RSHIFT(job.image.width, across), rows = AV_CEIL_RSHIFT(job.image.height, down);
  parallel_for(std::size_t(rows), [&](std::size_t row) {
    std::vector<float> sums(std::size_t(job.image.width));  // over the rows of the cells
    for (std::size_t t = 0; t < taps_down.weights.size() && job.image.colour_channels() == 3; ++t) {
      const int from = (int(row) << down) + taps_down.first + int(t);
      add_chroma(job, std::clamp(from, 0, job.image.height - 1), component, taps_down.weights[t], sums);
    }
    std::vector<std::uint32_t> line(static_cast<std::size_t>(columns));
    for (int x = 0; x < columns; ++x) {
      float value = 0;
      for (std::size_t t = 0; t < taps_across.weights.size(); ++t) {
        const int from = (x << across) + taps_across.first + int(t);
        value += taps_across.weights[t] * sums[std::size_t(std::clamp(from, 0, job.image.width - 1))];
      }
      line[std::size_t(x)] = stored(job, component, value, factor, 128 * step);
    }
    put_line(job, component, int(row), line);
  });
}

void put_alpha(const Job& job) {
  const int component = job.format.nb_components - 1;
  const int channel = job.image.channels - 1;
  put_component(job, component, false,
                [&](int x, int y) { return job.image.has_alpha() ? job.image.at(x, y, channel) : 255.0F; });
}

void put_colours(const Job& job) {
  if (is_rgb(job.format)) {
    for (int c = 0; c < 3; ++c) {
      put_component(job, c, false, [&](int x, int y) { return sample(job.image, x, y, c); });
    }
    return;
  }
  put_component(job, 0, !job.full && job.format.comp[0].depth >= 8,
                [&](int x, int y) { return luma(job, x, y); });
  if (is_grey(job.format)) return;
  put_chroma(job, 1);
  put_chroma(job, 2);
}

/// Components are put by "or" into what is there, and paddings should not tell of old memory.
void clear(AVFrame& frame) {
  for (const AVBufferRef* buffer : frame.buf) {
    if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
  }
}

}  // namespace

FramePtr packed_frame(const image::Image& image, AVPixelFormat format, const ColourTags& colour,
                      int coded_height) {
  FramePtr frame = new_frame();
  frame->format = format;
  frame->width = image.width;
  frame->height = image.height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  clear(*frame);
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
  const bool full = without_range(format) != format || full_range(colour.range, description);
  const int matrix = matrix_in_use(colour.matrix, coded_height);
  const Job job{image, *frame, description, luma_weights(matrix), chroma_place(colour.chroma_location), full};
  put_colours(job);
  if (has_alpha(description)) put_alpha(job);
  return frame;
}

image::Image with_channels(const image::Image& image, int channels) {
  image::Image result = image::make_image(image.width, image.height, channels);
  const LumaWeights weights = luma_weights(AVCOL_SPC_SMPTE170M);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < result.colour_channels(); ++c) result.at(x, y, c) = sample(image, x, y, c);
      if (result.colour_channels() == 1 && image.colour_channels() == 3) {
        result.at(x, y, 0) = weights.red * image.at(x, y, 0) + weights.green() * image.at(x, y, 1) +
                             weights.blue * image.at(x, y, 2);
      }
      if (!result.has_alpha()) continue;
      result.at(x, y, channels - 1) = image.has_alpha() ? image.at(x, y, image.channels - 1) : 255.0F;
    }
  }
  return result;
}

}  // namespace knotreel::video
