// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>

#include "knotreel/base/output_file.h"
#include "knotreel/image/read_image.h"
#include "knotreel/image/write_image.h"

/// What the codecs inside this module share. None of it is public.
namespace knotreel::image {

/// Why bytes are no picture; read_image() adds the file name and makes it an Error.
class DecodeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A decoded picture with the depth it had.
struct Decoded {
  Image image;
  SampleType samples = SampleType::u8;
  bool more_pages = false;  ///< as in ImageFileInfo
};

/// @throws DecodeError for sizes below 1 or above kMaxPixels.
void check_size(std::uint64_t width, std::uint64_t height);

// One decoder per family of formats; all throw DecodeError or std::bad_alloc.
Decoded decode_png(std::span<const std::byte> file);
Decoded decode_pnm(std::span<const std::byte> file);  // PBM, PGM, PPM, PAM, PFM
Decoded decode_tiff(std::span<const std::byte> file);
Decoded decode_with_opencv(std::span<const std::byte> file, ImageFormat format);

// Row writers; they own the open file. The spec has been checked against the format.
std::unique_ptr<RowWriter> make_png_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec);
std::unique_ptr<RowWriter> make_pnm_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec);
std::unique_ptr<RowWriter> make_tiff_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec);
std::unique_ptr<RowWriter> make_opencv_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec);

/// Common part of the row writers: checks the shape of what is handed in and counts rows.
class CheckedRowWriter : public RowWriter {
 public:
  CheckedRowWriter(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec)
      : file_(std::move(file)), spec_(spec) {}
  void write(std::span<const float> rows, int count) final;
  void finish() final;

 protected:
  virtual void write_row(std::span<const float> row) = 0;
  virtual void complete() = 0;  // everything before the file is committed

  OutputFile& file() { return *file_; }
  const ImageFileSpec& spec() const { return spec_; }
  int rows_written() const { return rows_written_; }

 private:
  std::unique_ptr<OutputFile> file_;
  ImageFileSpec spec_;
  int rows_written_ = 0;
};

/// Rounded to nearest and clamped; a value that is not a number becomes 0.
std::uint8_t to_u8(float sample);
std::uint16_t to_u16(float sample);

/// Appends samples as u8, or as u16 with the high byte first, to `bytes`.
void append_samples(std::span<const float> samples, SampleType type, std::vector<std::byte>& bytes);

}  // namespace knotreel::image
