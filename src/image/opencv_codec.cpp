#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "codec.h"
#include "probe.h"
#include "quiet.h"

// The only file that knows OpenCV. See docs/decisions/0002-png-and-pnm-without-opencv.md for what is not here.
namespace knotreel::image {
namespace {

/// From OpenCV's BGR order and own depth to ours.
Decoded from_mat(const cv::Mat& mat) {
  Decoded decoded;
  double scale = 1;
  switch (mat.depth()) {
    case CV_8U:
      decoded.samples = SampleType::u8;
      break;
    case CV_16U:
      decoded.samples = SampleType::u16;
      scale = 255.0 / 65535;
      break;
    case CV_32F:
    case CV_64F:
      decoded.samples = SampleType::f32;
      scale = 255;
      break;
    default:
      throw DecodeError("its kind of samples is not supported");
  }
  if (mat.channels() > 4) throw DecodeError("it has more than 4 channels");
  decoded.image = make_image(mat.cols, mat.rows, mat.channels());
  cv::Mat ours(mat.rows, mat.cols, CV_32FC(mat.channels()), decoded.image.samples.data());
  mat.convertTo(ours, CV_32F, scale);
  if (mat.channels() == 3) cv::cvtColor(ours, ours, cv::COLOR_BGR2RGB);
  if (mat.channels() == 4) cv::cvtColor(ours, ours, cv::COLOR_BGRA2RGBA);
  return decoded;
}

/// Most 32-bit BMP files have zeros, not alpha, in their fourth byte.
Image without_empty_alpha(const Image& image) {
  if (image.channels != 4) return image;
  for (std::size_t i = 3; i < image.samples.size(); i += 4) {
    if (image.samples[i] != 0) return image;
  }
  Image opaque = make_image(image.width, image.height, 3);
  for (std::size_t i = 0; i < opaque.samples.size(); ++i) opaque.samples[i] = image.samples[i / 3 * 4 + i % 3];
  return opaque;
}

/// Collects the rows of a format that OpenCV only writes as a whole.
class OpenCvWriter final : public CheckedRowWriter {
 public:
  OpenCvWriter(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec)
      : CheckedRowWriter(std::move(file), spec), mat_(spec.height, spec.width, type(spec)) {}

 private:
  static int type(const ImageFileSpec& spec) {
    const int depth = spec.samples == SampleType::u8 ? CV_8U : spec.samples == SampleType::u16 ? CV_16U : CV_32F;
    return CV_MAKETYPE(depth, spec.channels);
  }

  void write_row(std::span<const float> row) override {
    const cv::Mat ours(1, spec().width, CV_32FC(spec().channels), const_cast<float*>(row.data()));
    const double scale = spec().samples == SampleType::u8    ? 1
                         : spec().samples == SampleType::u16 ? 65535.0 / 255
                                                             : 1.0 / 255;
    cv::Mat target = mat_.row(rows_written());
    ours.convertTo(target, mat_.depth(), scale);
    if (spec().channels == 3) cv::cvtColor(target, target, cv::COLOR_RGB2BGR);
    if (spec().channels == 4) cv::cvtColor(target, target, cv::COLOR_RGBA2BGRA);
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
      case ImageFormat::kTiff:
        extension = ".tiff";
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
      throw Error(ErrorKind::kOutput, "cannot write '" + file().name() + "': " + why);
    };
    try {
      const QuietStandardError quiet;
      if (!cv::imencode(extension, mat_, encoded, options)) fail("the encoder refused the picture");
    } catch (const cv::Exception& e) {
      fail("the encoder refused the picture (" + e.err + ")");
    }
    file().write(std::as_bytes(std::span(encoded)));
  }

  cv::Mat mat_;
};

}  // namespace

Decoded decode_with_opencv(std::span<const std::byte> file, ImageFormat format) {
  const ProbedSize size = probe_size(file, format);
  check_size(size.width, size.height);
  // IMREAD_UNCHANGED keeps alpha but ignores the EXIF orientation; a JPEG has the latter and no alpha.
  const int flags =
      format == ImageFormat::kJpeg ? int{cv::IMREAD_ANYCOLOR} | int{cv::IMREAD_ANYDEPTH} : int{cv::IMREAD_UNCHANGED};
  try {
    cv::Mat mat;
    {
      const QuietStandardError quiet;
      const cv::Mat bytes(1, static_cast<int>(file.size()), CV_8U, const_cast<std::byte*>(file.data()));
      mat = cv::imdecode(bytes, flags);
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
