// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <utility>

#include "frame_to_image.h"
#include "image_to_frame.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/image/read_image.h"
#include "source.h"

namespace knotreel::video {
namespace {

/// A picture in memory and what is known of its file.
struct Picture {
  image::Image image;
  std::string codec, pixel_format;
  int depth = 8;
};

std::string format_of(int channels, int depth) {
  static constexpr const char* kNames[2][4] = {{"gray", "ya8", "rgb24", "rgba"},
                                               {"gray16le", "ya16le", "rgb48le", "rgba64le"}};
  return kNames[depth > 8 ? 1 : 0][channels - 1];
}

/// Files that the image module knows are read by it, so that a picture is the same here and there; the rest,
/// such as DPX and EXR, by libav.
Picture read_picture(const std::string& file, const ReadOptions& options) {
  const std::vector<std::byte> start = read_start(file, 16);
  Picture picture;
  if (const auto format = image::detect_format(start)) {
    image::ImageFileInfo info;
    picture.image = image::read_image(file, &info);
    picture.codec = image::format_name(*format);
    picture.depth = info.samples == image::SampleType::u8 ? 8 : 16;
    picture.pixel_format = format_of(picture.image.channels, picture.depth);
    return picture;
  }
  const std::unique_ptr<Source> source = open_stream(file, options);
  Frame frame;
  source->next(frame);
  picture.image = std::move(frame.image);
  picture.codec = source->info().codec;
  picture.pixel_format = source->info().pixel_format;
  picture.depth = source->info().depth;
  return picture;
}

class PictureSource : public Source {
 public:
  PictureSource(std::vector<std::string> files, const ReadOptions& options, std::uint64_t missing)
      : files_(std::move(files)), options_(options) {
    if (!options.image_rate.known())
      throw Error(ErrorKind::kInvalidArgument, "the image rate must be above 0");
    if (!options.filter.empty())
      throw Error(ErrorKind::kInvalidArgument, "filters are for videos, and these are pictures");
    options_.deinterlace = Deinterlace::kNone;
    // The first picture says what the frames are, so it has to be whole.
    first_ = read_picture(files_.front(), options_);
    describe(*first_);
    if (missing > 0) {
      warnings_.add(std::to_string(missing) +
                    " numbers between the first and the last picture are missing: the next picture follows");
    }
  }

  bool next(Frame& frame) override {
    std::optional<Picture> picture = std::exchange(first_, std::nullopt);
    while (!picture) {
      if (++at_ >= files_.size()) return false;
      picture = read_or_leave_out(files_[at_]);
    }
    frame.image = fitted(std::move(picture->image));
    frame.index = handed_out_++;
    frame.pts = std::int64_t(at_);
    frame.duration = 1;
    frame.packets.clear();
    return true;
  }

 private:
  void describe(const Picture& picture) {
    info_.width = picture.image.width;
    info_.height = picture.image.height;
    info_.channels = picture.image.channels;
    info_.depth = picture.depth;
    info_.pixel_format = picture.pixel_format;
    info_.codec = picture.codec;
    info_.container = "pictures";
    info_.frame_rate = options_.image_rate;
    info_.time_base = {options_.image_rate.den, options_.image_rate.num};
    info_.frames = files_.size();
    info_.seconds = double(files_.size()) / options_.image_rate.value();
    info_.timestamps = false;
    info_.still = files_.size() == 1;
  }

  /// A picture that cannot be read leaves a gap in time.
  std::optional<Picture> read_or_leave_out(const std::string& file) {
    try {
      return read_picture(file, options_);
    } catch (const Error& e) {
      if (options_.strict || e.kind() != ErrorKind::kInput) throw;
      ++damaged_;
      warnings_.count("pictures cannot be read and are left out");
      return {};
    }
  }

  image::Image fitted(image::Image image) {
    if (image.channels != info_.channels) {
      warnings_.count("pictures have other channels than the first, and are made like it");
      image = with_channels(image, info_.channels);
    }
    if (image.width != info_.width || image.height != info_.height) {
      warnings_.count("frames are of another size than the first, and scaled to it");
      image = resized(image, info_.width, info_.height);
    }
    return image;
  }

  std::vector<std::string> files_;
  ReadOptions options_;
  std::optional<Picture> first_;
  std::size_t at_ = 0;
  std::uint64_t handed_out_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_pictures(std::vector<std::string> files, const ReadOptions& options,
                                      std::uint64_t missing) {
  return std::make_unique<PictureSource>(std::move(files), options, missing);
}

}  // namespace knotreel::video
