// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/pictures.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/file_names.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/format.h"
#include "knotreel/image/read_image.h"
#include "knotreel/pipeline/sequence.h"
#include "knotreel/vectorize/vectorize.h"
#include "knotreel/video/picture_list.h"
#include "knotreel/video/reader.h"

namespace knotreel::cli {
namespace {

/// Of a document from standard input; it has to be held in memory.
constexpr std::uint64_t kMaxPipedBytes = std::uint64_t{1} << 32;

/// Rows handed over at once: about a million pixels.
int band_rows(int width) {
  return std::max(1, (1 << 20) / width);
}

struct Band {
  int rows = 0;
  std::vector<float> samples;
};

/// What comes through a pipe can be read once.
bool is_pipe(const std::filesystem::path& path) {
  std::error_code ignored;
  return path == "-" || std::filesystem::is_fifo(path, ignored);
}

std::string name_of_pipe(const std::filesystem::path& path) {
  return path == "-" ? "standard input" : path.string();
}

void warn_if_cut_short(const std::filesystem::path& path, const document::Reader& reader) {
  if (reader.complete()) return;
  const std::string name = quoted(path.string(), "standard input");
  warn(name + " is cut short: read up to its last whole frame");
}

}  // namespace

bool is_picture(const std::filesystem::path& path) {
  if (is_pipe(path)) return true;
  const std::vector<std::byte> start = read_start(path, video::kPictureStart);
  if (image::detect_format(start)) return video::holds_one_picture(start, path.string());
  return has_picture_name(path);
}

document::Reader open_document_silently(const std::filesystem::path& path) {
  if (video::means_pictures(path)) {
    throw Error(ErrorKind::kInput, "'" + path.string() + "' is no document; 'knotreel copy " + path.string() +
                                       " -o x.tcb' makes one of several");
  }
  if (!is_pipe(path)) return document::Reader::open(path);
  return document::Reader::open(read_whole(path, kMaxPipedBytes, "document"), name_of_pipe(path));
}

document::Reader open_document(const std::filesystem::path& path) {
  document::Reader reader = open_document_silently(path);
  warn_if_cut_short(path, reader);
  return reader;
}

Turn turn_of(const document::Reader& reader) {
  return video::turn_of(pipeline::stream_info(reader.info()));
}

document::FrameModel read_frame(document::Reader& reader, std::uint64_t frame) {
  if (frame >= reader.frame_count()) {
    throw Error(ErrorKind::kInvalidArgument, "there is no frame " + std::to_string(frame) +
                                                 ": the document has " +
                                                 std::to_string(reader.frame_count()) + ", counted from 0");
  }
  return reader.read(frame);
}

void warn_of_other_frames(const std::string& path, const document::Reader& reader, bool told) {
  if (told || reader.frame_count() <= 1) return;
  warn_of(path, {"only the first of " + std::to_string(reader.frame_count()) +
                 " frames is drawn; --frame takes another one, a name with %04d all"});
}

image::Image read_source(const std::filesystem::path& path, image::ImageFileInfo* info) {
  image::Image image = image::read_image(path, info);
  const auto is_large = [](float sample) { return std::abs(sample) > vectorize::kLargestSample; };
  if (std::ranges::any_of(image.samples, is_large)) {
    throw Error(ErrorKind::kInput,
                cannot_read(path, "image") + "it holds samples of more than 10000 times white");
  }
  return image;
}

void stream_rendering(const raster::Renderer& renderer, const image::Background& background,
                      image::RowWriter& writer) {
  const std::size_t row_size = std::size_t(renderer.width()) * std::size_t(renderer.channels());
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
        image::put_on_background(ready.samples, renderer.channels(), background);
        writer.write(ready.samples, ready.rows);
      }
    });
    top += next.rows;
    std::swap(ready, next);
  }
  check_interrupted();
}

image::Image render_whole(const document::FrameModel& model, const raster::RenderOptions& options) {
  return raster::Renderer(model, options).whole();
}

namespace {

/// As it is shown.
image::Image draw_frame(document::Reader& reader, std::uint64_t frame) {
  return video::turned(render_whole(read_frame(reader, frame), {}), turn_of(reader));
}

/// Read first and looked at then: what comes through a pipe may be either.
image::Image load_piped(const std::filesystem::path& path, const std::optional<std::uint64_t>& frame) {
  std::vector<std::byte> bytes = read_whole(path, kMaxPipedBytes, "picture or document");
  if (!begins_document(bytes)) return image::read_image(bytes, path);
  document::Reader reader = document::Reader::open(std::move(bytes), name_of_pipe(path));
  warn_if_cut_short(path, reader);
  if (!frame && reader.frame_count() > 1) {
    warn_of(path, {"only the first of " + std::to_string(reader.frame_count()) +
                   " frames is compared, since it comes through a pipe; --frame takes another one"});
  }
  return draw_frame(reader, frame.value_or(0));
}

}  // namespace

image::Image load_picture(const std::filesystem::path& path, const std::optional<std::uint64_t>& frame) {
  if (is_pipe(path)) return load_piped(path, frame);
  if (is_picture(path)) return image::read_image(path);
  document::Reader reader = open_document(path);
  return draw_frame(reader, frame.value_or(0));
}

}  // namespace knotreel::cli
