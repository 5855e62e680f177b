// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// A picture file that is written from top to bottom. Made by open_image_writer(). Destroyed before finish(),
/// it leaves no file behind. One thread at a time.
class RowWriter {
 public:
  virtual ~RowWriter() = default;

  /// Appends rows: row-major, channels interleaved, scale 0..255. Integer samples are rounded to nearest and
  /// clamped; floats are stored as they are, divided by 255.
  /// @param rows   count x width x channels values.
  /// @throws Error{kOutput} if the file cannot be written, Error{kInvalidArgument} if the shape is wrong.
  virtual void write(std::span<const float> rows, int count) = 0;

  /// Completes the file and gives it its name. @throws Error{kInvalidArgument} unless all rows have been
  /// written, Error{kOutput}.
  virtual void finish() = 0;
};

/// What a picture file is to be. PNG (u8, u16; any channels), PNM (u8, u16; 1 or 3 channels), PAM (u8, u16;
/// any) and PFM (f32; 1 or 3; not into a pipe) are written row by row, so memory does not grow with the
/// picture. TIFF (u8, u16, f32; any), JPEG and BMP (u8; 1, 3) and WebP (u8; 1, 3, 4) are held
/// in memory until finish() and limited to kMaxPixels; JPEG to 65500 and WebP to 16383 pixels on a side.
struct ImageFileSpec {
  int width = 0;
  int height = 0;
  int channels = 0;
  SampleType samples = SampleType::u8;
  std::optional<ImageFormat> format;  ///< none: by the extension of the path; `-` becomes PNG
  /// That the file is to have: 1 or 3, into which grey is widened; 0: as many as the picture. If there is no
  /// `format`, the extension of the path says it (channels_of_extension()).
  int file_channels = 0;
};

/// Refuses what cannot be written before anything is drawn for it. @throws Error{kInvalidArgument} as
/// open_image_writer().
void check_image_spec(const std::filesystem::path& path, const ImageFileSpec& spec);

/// Opens a picture for writing; `-` is standard output. See OutputFile for how files get their names.
/// @throws Error{kInvalidArgument} if the format is unknown or does not hold such samples, channels or sizes,
/// Error{kOutput} if the file cannot be opened.
std::unique_ptr<RowWriter> open_image_writer(const std::filesystem::path& path, const ImageFileSpec& spec);

/// Writes a whole picture; errors as above.
void write_image(const std::filesystem::path& path, const Image& image, SampleType samples = SampleType::u8);

}  // namespace knotreel::image
