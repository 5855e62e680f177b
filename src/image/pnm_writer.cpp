// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <string>

#include "codec.h"

namespace knotreel::image {
namespace {

const char* tuple_type(int channels) {
  switch (channels) {
    case 1:
      return "GRAYSCALE";
    case 2:
      return "GRAYSCALE_ALPHA";
    case 3:
      return "RGB";
    default:
      return "RGB_ALPHA";
  }
}

/// PGM, PPM and PAM: a line of text and raw samples, high byte first.
class RawWriter final : public CheckedRowWriter {
 public:
  RawWriter(std::unique_ptr<OutputFile> opened, const ImageFileSpec& spec)
      : CheckedRowWriter(std::move(opened), spec) {
    widened_ = spec.channels == 1 && spec.file_channels == 3;
    const std::string width = std::to_string(spec.width);
    const std::string height = std::to_string(spec.height);
    const std::string maxval = spec.samples == SampleType::u16 ? "65535" : "255";
    if (spec.format == ImageFormat::kPam) {
      file().write("P7\nWIDTH " + width + "\nHEIGHT " + height + "\nDEPTH " + std::to_string(spec.channels) +
                   "\nMAXVAL " + maxval + "\nTUPLTYPE " + tuple_type(spec.channels) + "\nENDHDR\n");
    } else {
      file().write(std::string(spec.channels == 1 && !widened_ ? "P5" : "P6") + "\n" + width + " " + height +
                   "\n" + maxval + "\n");
    }
  }

 private:
  void write_row(std::span<const float> row) override {
    encoded_.clear();
    append_samples(widened_ ? as_colours(row) : row, spec().samples, encoded_);
    file().write(encoded_);
  }
  void complete() override {}

  std::span<const float> as_colours(std::span<const float> greys) {
    colours_.clear();
    for (const float grey : greys) colours_.insert(colours_.end(), 3, grey);
    return colours_;
  }

  bool widened_ = false;  ///< grey, in a file of colours
  std::vector<float> colours_;
  std::vector<std::byte> encoded_;
};

/// PFM keeps its rows from bottom to top, so each is put where it belongs.
class PfmWriter final : public CheckedRowWriter {
 public:
  PfmWriter(std::unique_ptr<OutputFile> opened, const ImageFileSpec& spec)
      : CheckedRowWriter(std::move(opened), spec) {
    constexpr bool kLittle = std::endian::native == std::endian::little;
    file().write(std::string(spec.channels == 1 ? "Pf" : "PF") + "\n" + std::to_string(spec.width) + " " +
                 std::to_string(spec.height) + "\n" + (kLittle ? "-1.0" : "1.0") + "\n");
    first_byte_ = file().size();
  }

 private:
  void write_row(std::span<const float> row) override {
    scaled_.assign(row.begin(), row.end());
    for (float& sample : scaled_) sample /= 255.0F;
    const auto bytes = std::as_bytes(std::span(scaled_));
    const auto place = static_cast<std::uint64_t>(spec().height - 1 - rows_written());
    file().write_at(first_byte_ + place * bytes.size(), bytes);
  }
  void complete() override {}

  std::uint64_t first_byte_ = 0;
  std::vector<float> scaled_;
};

}  // namespace

std::unique_ptr<RowWriter> make_pnm_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec) {
  if (spec.format == ImageFormat::kPfm) return std::make_unique<PfmWriter>(std::move(file), spec);
  return std::make_unique<RawWriter>(std::move(file), spec);
}

}  // namespace knotreel::image
