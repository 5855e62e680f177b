// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>

#include "codec.h"
#include "imgcodecs.h"
#include "probe.h"
#include "quiet.h"

// The only file of this module that knows OpenCV, but for its loading; what is not here:
// docs/decisions/0002-png-and-pnm-without-opencv.md.
namespace knotreel::image {
namespace {

/// Position in our RGB(A) order of channel c in OpenCV's BGR(A); the exchange is its own inverse.
int swapped(int c, int channels) {
  return channels >= 3 && c < 3 ? 2 - c : c;
}

Decoded from_mat(const cv::Mat& mat) {
  const int channels = mat.channels();
  if (channels > 4) throw DecodeError("it has more than 4 channels");
  if (mat.depth() != CV_8U) throw DecodeError("its kind of samples is not supported");
  Decoded decoded{make_image(mat.cols, mat.rows, channels), SampleType::u8};
  for (int y = 0; y < mat.rows; ++y) {
    const auto* from = mat.ptr<std::uint8_t>(y);
    float* to = decoded.image.row(y).data();
    for (int x = 0; x < mat.cols; ++x, from += channels, to += channels) {
      for (int c = 0; c < channels; ++c) to[c] = static_cast<float>(from[swapped(c, channels)]);
    }
  }
  return decoded;
}

/// Most 32-bit BMP files have zeros, not alpha, in their fourth byte.
Image without_empty_alpha(const Image& image) {
  if (image.channels != 4) return image;
  for (std::size_t i = 3; i < image.samples.size(); i += 4) {
    if (image.samples[i] != 0) return image;
  }
  Image opaque = make_image(image.width, image.height, 3);
  for (std::size_t i = 0; i < opaque.samples.size(); ++i)
    opaque.samples[i] = image.samples[i / 3 * 4 + i % 3];
  return opaque;
}

/// Collects the rows, of 8 bits, of a format that OpenCV only writes as a whole.
class OpenCvWriter final : public CheckedRowWriter {
 public:
  OpenCvWriter(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec)
      : CheckedRowWriter(std::move(file), spec),
        mat_(spec.height, spec.width, CV_MAKETYPE(CV_8U, spec.channels)) {}

 private:
  void write_row(std::span<const float> row) override {
    const int channels = spec().channels;
    auto* to = mat_.ptr<std::uint8_t>(rows_written());
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int c = static_cast<int>(i % std::size_t(channels));
      to[i - std::size_t(c) + std::size_t(swapped(c, channels))] = to_u8(row[i]);
    }
  }

  void complete() override {
    std::vector<unsigned char> encoded;
    std::vector<int> options;
    std::string extension;
    switch (*spec().format) {
      case ImageFormat::kJpeg:
        extension = ".jpg";
        options = {cv::IMWRITE_JPEG_QUALITY, 95};
        break;
      case ImageFormat::kWebp:
        extension = ".webp";
        options = {cv::IMWRITE_WEBP_QUALITY, 101};  // above 100: lossless
        break;
      default:
        extension = ".bmp";
        break;
    }
    const auto fail = [&](const std::string& why) {
      throw Error(ErrorKind::kOutput, "cannot write " + file().name() + ": " + why);
    };
    std::string why;
    const Imgcodecs* codecs = imgcodecs(why);
    if (codecs == nullptr) fail("the encoder cannot be loaded (" + why + ")");
    try {
      const QuietStandardError quiet;
      if (!codecs->encode(extension, mat_, encoded, options)) fail("the encoder refused the picture");
    } catch (const cv::Exception& e) {
      fail("the encoder refused the picture (" + e.err + ")");
    }
    file().write(std::as_bytes(std::span(encoded)));
  }

  cv::Mat mat_;
};

/// What OpenCV does not read, and tells nothing of, or reads wrongly.
void check_kind(std::span<const std::byte> file, ImageFormat format) {
  const auto byte_at = [&](std::size_t i) {
    return i < file.size() ? std::to_integer<unsigned>(file[i]) : 0U;
  };
  const bool extended_webp = format == ImageFormat::kWebp && byte_at(12) == 'V' && byte_at(15) == 'X';
  if (extended_webp && (byte_at(20) & 2U) != 0)
    throw DecodeError("it is an animated WebP, which is not read; a GIF, an APNG or a video of it is");
  if (format == ImageFormat::kBmp && byte_at(14) == 12 && byte_at(15) == 0)
    throw DecodeError("it is a BMP of OS/2, which is not read");  // colours would come out as grey
}

}  // namespace

Decoded decode_with_opencv(std::span<const std::byte> file, ImageFormat format) {
  check_kind(file, format);
  const ProbedSize size = probe_size(file, format);
  check_size(size.width, size.height);
  // IMREAD_UNCHANGED keeps alpha but ignores the EXIF orientation; a JPEG has the latter and no alpha.
  const int flags = format == ImageFormat::kJpeg ? int{cv::IMREAD_ANYCOLOR} | int{cv::IMREAD_ANYDEPTH}
                                                 : int{cv::IMREAD_UNCHANGED};
  std::string why;
  const Imgcodecs* codecs = imgcodecs(why);
  if (codecs == nullptr) throw DecodeError("the decoder cannot be loaded (" + why + ")");
  try {
    cv::Mat mat;
    {
      const QuietStandardError quiet;
      const cv::Mat bytes(1, static_cast<int>(file.size()), CV_8U, const_cast<std::byte*>(file.data()));
      mat = codecs->decode(bytes, flags);
    }
    if (mat.empty()) throw DecodeError("the file is damaged or cut short");
    check_size(std::uint64_t(mat.cols), std::uint64_t(mat.rows));
    Decoded decoded = from_mat(mat);
    if (format == ImageFormat::kBmp) decoded.image = without_empty_alpha(decoded.image);
    return decoded;
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw DecodeError("the file is damaged (" + e.err + ")");
  }
}

std::unique_ptr<RowWriter> make_opencv_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec) {
  try {
    return std::make_unique<OpenCvWriter>(std::move(file), spec);
  } catch (const cv::Exception&) {
    throw std::bad_alloc();
  }
}

}  // namespace knotreel::image
