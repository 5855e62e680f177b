// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tiffio.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace knotreel::image {

/// The most memory that libtiff may take for one thing, and we for the stored samples of one place.
inline constexpr std::uint64_t kMaxTiffBlock = std::uint64_t{1} << 31;

/// A TIFF or BigTIFF in memory at its first page. libtiff says nothing to standard error: what it says first
/// becomes our error.
class TiffFile {
 public:
  /// @throws DecodeError if the directory of the first page is damaged.
  explicit TiffFile(std::span<const std::byte> file);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  TIFF* handle() const { return tiff_; }
  std::uint64_t size() const { return file_.size(); }

  /// A tag with one value, by the type that libtiff gives it; `otherwise` if it is missing and has no
  /// default.
  template <typename T>
  T tag(std::uint32_t number, T otherwise) const {
    T value = otherwise;
    return TIFFGetFieldDefaulted(tiff_, number, &value) != 0 ? value : otherwise;
  }

  /// Tells what libtiff complained of, which is that the file is damaged or cut short if it is silent.
  [[noreturn]] void fail() const;

 private:
  static TiffFile& self(thandle_t handle) { return *static_cast<TiffFile*>(handle); }
  static tmsize_t read(thandle_t handle, void* to, tmsize_t count);
  static toff_t seek(thandle_t handle, toff_t offset, int origin);
  static int map(thandle_t handle, void** start, toff_t* size);
  static int on_error(TIFF* tiff, void* file, const char* module, const char* format, va_list arguments);

  std::span<const std::byte> file_;
  std::uint64_t position_ = 0;
  std::array<char, 200> error_{};  // not a string: an exception must not cross libtiff's C frames
  TIFF* tiff_ = nullptr;
};

}  // namespace knotreel::image
