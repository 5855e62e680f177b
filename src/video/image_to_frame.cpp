// SPDX-License-Identifier: GPL-3.0-or-later
#include "image_to_frame.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

#include "base/multiversion.h"
#include "colour_rules.h"
#include "dither.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/background.h"
#include "palette.h"

namespace knotreel::video {
namespace {

/// Steps of a sample from what it was to what it should be, up to which it stays. Half a step is what
/// rounding misses in any case.
constexpr double kHeld = 0.7;

/// Everything that a row of the target needs to know.
struct Job {
  const image::Image& image;
  AVFrame& frame;
  const AVFrame* before;  // or null
  const AVPixFmtDescriptor& format;
  LumaWeights weights;
  ChromaPlace place;
  bool full;
};

template <std::size_t Channels>
[[gnu::always_inline]] inline void luma_of(const float* __restrict pixels, const LumaWeights& weights,
                                           std::size_t count, float* __restrict luma) {
  const float red = weights.red, green = weights.green(), blue = weights.blue;
  for (std::size_t x = 0; x < count; ++x) {
    const float* const p = pixels + x * Channels;
    luma[x] = red * p[0] + green * p[1] + blue * p[2];
  }
}

/// Of a line of RGB, with alpha or without.
KNOTREEL_MULTIVERSION
void luma_line(const float* pixels, std::size_t channels, const LumaWeights& weights, std::size_t count,
               float* luma) {
  if (channels == 3) return luma_of<3>(pixels, weights, count, luma);
  return luma_of<4>(pixels, weights, count, luma);
}

/// Of a row, or its values if it is grey.
std::vector<float>& luma_row(const Job& job, int row) {
  thread_local std::vector<float> luma;
  const auto width = std::size_t(job.image.width);
  luma.resize(width);
  if (job.image.colour_channels() == 1) {
    for (std::size_t x = 0; x < width; ++x) luma[x] = job.image.at(int(x), row, 0);
  } else {
    luma_line(job.image.row(row).data(), std::size_t(job.image.channels), job.weights, width, luma.data());
  }
  return luma;
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

template <std::size_t Channels>
[[gnu::always_inline]] inline void add_chroma_of(const float* __restrict pixels, const float* __restrict luma,
                                                 float to_blue, float to_red, std::size_t count,
                                                 float* __restrict blue, float* __restrict red) {
  for (std::size_t x = 0; x < count; ++x) {
    blue[x] += to_blue * (pixels[x * Channels + 2] - luma[x]);
    red[x] += to_red * (pixels[x * Channels] - luma[x]);
  }
}

/// Adds the chroma of a line of RGB, times factors.
KNOTREEL_MULTIVERSION
void add_chroma_line(const float* pixels, std::size_t channels, const float* luma, float to_blue,
                     float to_red, std::size_t count, float* blue, float* red) {
  if (channels == 3) return add_chroma_of<3>(pixels, luma, to_blue, to_red, count, blue, red);
  return add_chroma_of<4>(pixels, luma, to_blue, to_red, count, blue, red);
}

/// Blue and red chroma of a row of pixels, on the scale -127.5..127.5.
struct ChromaSums {
  std::vector<float> blue, red;

  void clear(std::size_t width) {
    blue.assign(width, 0.0F);
    red.assign(width, 0.0F);
  }

  /// Adds those of a row of the picture, which has colours, times a weight.
  void add(const Job& job, int row, float weight) {
    add_chroma_line(job.image.row(row).data(), std::size_t(job.image.channels), luma_row(job, row).data(),
                    weight / (2 * (1 - job.weights.blue)), weight / (2 * (1 - job.weights.red)), blue.size(),
                    blue.data(), red.data());
  }
};

/// Rounded, for samples of up to 31 bits.
KNOTREEL_MULTIVERSION
void round_line(const float* values, double factor, double offset, double most, std::size_t count,
                std::uint32_t* line) {
  for (std::size_t x = 0; x < count; ++x) {
    const double rounded = double(values[x]) * factor + offset + 0.5;
    const double low = rounded < 0 ? 0 : rounded;
    line[x] = std::uint32_t(std::int32_t(low > most ? most : low));
  }
}

/// Puts samples back that the values are near to.
KNOTREEL_MULTIVERSION
void hold_line(const float* values, double factor, double offset, const std::uint32_t* before,
               std::size_t count, std::uint32_t* line) {
  for (std::size_t x = 0; x < count; ++x) {
    const double off = double(values[x]) * factor + offset - double(std::int32_t(before[x]));
    line[x] = (off <= kHeld) & (off >= -kHeld) ? before[x] : line[x];
  }
}

/// The samples of the frame before in the place of a line.
std::vector<std::uint32_t>& line_before(const Job& job, int component, int y, std::size_t count) {
  thread_local std::vector<std::uint32_t> line;
  line.resize(count);
  const std::uint8_t* planes[4];
  std::copy_n(job.before->data, 4, planes);
  av_read_image_line2(line.data(), planes, job.before->linesize, &job.format, 0, y, component, int(count), 0,
                      4);
  return line;
}

/// Puts a line of values as the samples that they are stored as.
void put_line(const Job& job, int component, int y, const std::vector<float>& values, float factor,
              float offset) {
  thread_local std::vector<std::uint32_t> line;
  line.resize(values.size());
  const int depth = job.format.comp[component].depth;
  const double most = double((std::int64_t{1} << depth) - 1);
  if (depth < 32) {
    round_line(values.data(), double(factor), double(offset), most, values.size(), line.data());
    if (job.before != nullptr) {
      hold_line(values.data(), double(factor), double(offset),
                line_before(job, component, y, values.size()).data(), values.size(), line.data());
    }
  } else {
    std::transform(values.begin(), values.end(), line.begin(), [&](float value) {
      return std::uint32_t(std::clamp(double(value) * double(factor) + double(offset) + 0.5, 0.0, most));
    });
  }
  av_write_image_line2(line.data(), job.frame.data, job.frame.linesize, &job.format, 0, y, component,
                       int(line.size()), 4);
}

/// A component that every pixel has: all but chroma. @param values of a row.
template <class Values>
void put_component(const Job& job, int component, bool limited, const Values& values) {
  const int depth = job.format.comp[component].depth;
  const float step = limited ? float(1 << (depth - 8)) : float((std::int64_t{1} << depth) - 1) / 255.0F;
  const float factor = limited ? step * 219.0F / 255.0F : step;
  const float offset = limited ? 16 * step : 0;
  parallel_for(std::size_t(job.image.height), [&](std::size_t row) {
    put_line(job, component, int(row), values(int(row)), factor, offset);
  });
}

/// A channel of the picture as it is.
void put_channel(const Job& job, int component, int channel) {
  put_component(job, component, false, [&](int y) -> const std::vector<float>& {
    thread_local std::vector<float> values;
    values.resize(std::size_t(job.image.width));
    for (int x = 0; x < job.image.width; ++x) values[std::size_t(x)] = job.image.at(x, y, channel);
    return values;
  });
}

void put_chroma(const Job& job) {
  const int depth = job.format.comp[1].depth;
  const float step = float(1 << (depth - 8));
  const float factor = job.full ? float((1 << depth) - 1) / 255.0F : step * 224.0F / 255.0F;
  const int across = job.format.log2_chroma_w, down = job.format.log2_chroma_h;
  const Taps taps_across = taps(1 << across, job.place.x), taps_down = taps(1 << down, job.place.y);
  const int columns = AV_CEIL_RSHIFT(job.image.width, across), rows = AV_CEIL_RSHIFT(job.image.height, down);
  const auto put = [&](int component, int row, const std::vector<float>& sums) {
    thread_local std::vector<float> values;
    values.resize(std::size_t(columns));
    for (int x = 0; x < columns; ++x) {
      float value = 0;
      for (std::size_t t = 0; t < taps_across.weights.size(); ++t) {
        const int from = (x << across) + taps_across.first + int(t);
        value += taps_across.weights[t] * sums[std::size_t(std::clamp(from, 0, job.image.width - 1))];
      }
      values[std::size_t(x)] = value;
    }
    put_line(job, component, row, values, factor, 128 * step);
  };
  parallel_for(std::size_t(rows), [&](std::size_t row) {
    thread_local ChromaSums sums;  // over the rows of the cells
    sums.clear(std::size_t(job.image.width));
    for (std::size_t t = 0; t < taps_down.weights.size() && job.image.colour_channels() == 3; ++t) {
      const int from = (int(row) << down) + taps_down.first + int(t);
      sums.add(job, std::clamp(from, 0, job.image.height - 1), taps_down.weights[t]);
    }
    put(1, int(row), sums.blue);
    put(2, int(row), sums.red);
  });
}

void put_alpha(const Job& job) {
  const int component = job.format.nb_components - 1;
  if (job.image.has_alpha()) return put_channel(job, component, job.image.channels - 1);
  const std::vector<float> opaque(std::size_t(job.image.width), 255.0F);
  put_component(job, component, false, [&](int) -> const std::vector<float>& { return opaque; });
}

void put_colours(const Job& job) {
  if (is_rgb(job.format)) {
    for (int c = 0; c < 3; ++c) put_channel(job, c, job.image.colour_channels() == 1 ? 0 : c);
    return;
  }
  put_component(job, 0, !job.full && job.format.comp[0].depth >= 8,
                [&](int y) -> const std::vector<float>& { return luma_row(job, y); });
  if (!is_grey(job.format)) put_chroma(job);
}

image::Image on_black(const image::Image& image) {
  return image::on_background(image, image::Background{{0, 0, 0}});
}

Palette palette_of(const AVFrame& frame) {
  Palette palette;
  std::memcpy(palette.colours.data(), frame.data[1], sizeof palette.colours);
  palette.first = palette.colours[0] == 0 ? 1 : 0;
  const auto begin = palette.colours.begin() + std::ptrdiff_t(palette.first);
  palette.count = std::size_t(std::find(begin, palette.colours.end(), 0U) - begin);
  return palette;
}

/// @param before  in a palette, too; or null.
void put_in_palette(const image::Image& image, const AVFrame* before, AVFrame& frame) {
  const auto width = std::size_t(image.width), height = std::size_t(image.height);
  std::optional<Palette> last;
  if (before != nullptr) last = palette_of(*before);
  const Palette palette = choose_palette(image, last ? &*last : nullptr);
  std::vector<std::uint8_t> indices_before;
  if (last && last->colours == palette.colours) {
    for (std::size_t y = 0; y < height; ++y) {
      const std::uint8_t* const row = before->data[0] + std::ptrdiff_t(y) * before->linesize[0];
      indices_before.insert(indices_before.end(), row, row + width);
    }
  }
  const std::vector<std::uint8_t> indices = dithered(image, palette, indices_before);
  for (std::size_t y = 0; y < height; ++y)
    std::copy_n(&indices[y * width], width, frame.data[0] + std::ptrdiff_t(y) * frame.linesize[0]);
  std::memcpy(frame.data[1], palette.colours.data(), sizeof palette.colours);
}

/// Components are put by "or" into what is there, and paddings should not tell of old memory.
void clear(AVFrame& frame) {
  for (const AVBufferRef* buffer : frame.buf) {
    if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
  }
}

}  // namespace

FramePtr packed_frame(const image::Image& image, AVPixelFormat format, const ColourTags& colour,
                      int coded_height, const AVFrame* before) {
  const AVPixFmtDescriptor& description = *av_pix_fmt_desc_get(format);
  if (image.has_alpha() && !has_alpha(description)) {
    return packed_frame(on_black(image), format, colour, coded_height, before);
  }
  FramePtr frame = new_frame();
  frame->format = format;
  frame->width = image.width;
  frame->height = image.height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  clear(*frame);
  if (format == AV_PIX_FMT_PAL8) {
    put_in_palette(image, before, *frame);
    return frame;
  }
  const bool full = without_range(format) != format || full_range(colour.range, description);
  const int matrix = matrix_in_use(colour.matrix, coded_height);
  const Job job{
      image, *frame, before, description, luma_weights(matrix), chroma_place(colour.chroma_location), full};
  put_colours(job);
  if (has_alpha(description)) put_alpha(job);
  return frame;
}

image::Image with_channels(const image::Image& image, int channels) {
  if (image.has_alpha() && channels % 2 != 0) return with_channels(on_black(image), channels);
  image::Image result = image::make_image(image.width, image.height, channels);
  const LumaWeights weights = luma_weights(AVCOL_SPC_SMPTE170M);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < result.colour_channels(); ++c)
        result.at(x, y, c) = image.at(x, y, image.colour_channels() == 1 ? 0 : c);
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
