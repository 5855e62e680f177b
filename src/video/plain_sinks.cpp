// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

extern "C" {
#include <libavutil/sha.h>
}

#include "knotreel/base/error.h"
#include "knotreel/image/write_image.h"
#include "knotreel/video/picture_list.h"
#include "libav.h"
#include "sink.h"

namespace knotreel::video {
namespace {

class NullSink : public Sink {
 public:
  void write(const image::Image&, std::int64_t, std::int64_t) override {}
  void finish() override {}
};

/// A digest of what a viewer sees and when; the same on every machine.
class HashSink : public Sink {
 public:
  explicit HashSink(const StreamInfo& frames) : deep_(frames.depth > 8), sha_(allocated(av_sha_alloc())) {
    av_sha_init(sha_, 256);
    for (const std::int64_t value :
         {std::int64_t(frames.width), std::int64_t(frames.height), std::int64_t(frames.channels),
          frames.time_base.num, frames.time_base.den}) {
      add_number(value);
    }
  }
  ~HashSink() override { av_free(sha_); }

  void write(const image::Image& image, std::int64_t pts, std::int64_t duration) override {
    add_number(pts);
    add_number(duration);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.samples.size() * (deep_ ? 2 : 1));
    for (const float sample : image.samples) {
      const auto value =
          unsigned(std::lround(std::fmin(std::fmax(sample, 0.0F), 255.0F) * (deep_ ? 257 : 1)));
      bytes.push_back(std::uint8_t(value & 255));
      if (deep_) bytes.push_back(std::uint8_t(value >> 8));
    }
    av_sha_update(sha_, bytes.data(), bytes.size());
  }

  void finish() override {
    std::array<std::uint8_t, 32> sum{};
    av_sha_final(sha_, sum.data());
    digest_ = "sha256:";
    for (const std::uint8_t byte : sum) {
      digest_ += "0123456789abcdef"[byte >> 4];
      digest_ += "0123456789abcdef"[byte & 15];
    }
  }

  std::string digest() const override { return digest_; }

 private:
  void add_number(std::int64_t value) {
    std::array<std::uint8_t, 8> bytes{};
    for (std::size_t i = 0; i < 8; ++i) bytes[i] = std::uint8_t(std::uint64_t(value) >> (8 * i));
    av_sha_update(sha_, bytes.data(), bytes.size());
  }

  bool deep_;
  AVSHA* sha_;
  std::string digest_;
};

image::SampleType sample_type(const std::string& extension, const StreamInfo& frames,
                              const WriteOptions& options) {
  const auto format = image::format_of_extension(extension);
  if (!format) {
    throw Error(ErrorKind::kInvalidArgument, "pictures cannot be written as '" + extension +
                                                 "'; there are png, jpg, tif, webp, bmp, ppm, pam, pfm");
  }
  if (options.samples) return *options.samples;
  const bool deep = *format == image::ImageFormat::kPng || *format == image::ImageFormat::kTiff ||
                    *format == image::ImageFormat::kPnm || *format == image::ImageFormat::kPam;
  return deep && frames.depth > 8 ? image::SampleType::u16 : image::default_samples(*format);
}

/// One file per frame, or, for a plain name, one file.
class PictureSink : public Sink {
 public:
  PictureSink(const std::string& output, const StreamInfo& frames, const WriteOptions& options)
      : output_(output) {
    const std::string extension = output_.extension().string();
    samples_ = sample_type(extension.empty() ? extension : extension.substr(1), frames, options);
    image::check_image_spec(output_,
                            {frames.width, frames.height, frames.channels, samples_, std::nullopt, 0});
  }

  void write(const image::Image& image, std::int64_t, std::int64_t) override {
    const auto pattern = number_pattern(output_.string());
    if (!pattern && written_ == 0) {
      only_ = image;  // there might come another one, and then nothing is to be replaced
      ++written_;
      return;
    }
    if (!pattern) {
      const std::string extension = output_.extension().string();
      const bool may_move = image::format_of_extension(extension.substr(1)) == image::ImageFormat::kWebp;
      throw Error(ErrorKind::kInvalidArgument,
                  "'" + output_.string() + "' holds one frame; for more, use a name such as frame_%04d" +
                      extension + (may_move ? ", or --format webp for an animation" : ""));
    }
    ++written_;
    image::write_image(output_.parent_path() / pattern->name(written_), image, samples_);
  }
  void finish() override {
    if (only_) image::write_image(output_, *only_, samples_);
  }

 private:
  std::filesystem::path output_;
  image::SampleType samples_;
  std::uint64_t written_ = 0;
  std::optional<image::Image> only_;  ///< frame of a plain name
};

}  // namespace

std::unique_ptr<Sink> make_null_sink() {
  return std::make_unique<NullSink>();
}

std::unique_ptr<Sink> make_hash_sink(const StreamInfo& frames) {
  return std::make_unique<HashSink>(frames);
}

std::unique_ptr<Sink> make_picture_sink(const std::string& output, const StreamInfo& frames,
                                        const WriteOptions& options) {
  return std::make_unique<PictureSink>(output, frames, options);
}

}  // namespace knotreel::video
