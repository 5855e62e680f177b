// SPDX-License-Identifier: GPL-3.0-or-later
#include "tiff_file.h"

#include <algorithm>
#include <cctype>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "codec.h"

namespace knotreel::image {
namespace {

tmsize_t write_nothing(thandle_t, void*, tmsize_t) {
  return 0;
}

int close_nothing(thandle_t) {
  return 0;
}

void unmap_nothing(thandle_t, void*, toff_t) {}

int on_tiff_warning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;  // it has been dealt with
}

}  // namespace

tmsize_t TiffFile::read(thandle_t handle, void* to, tmsize_t count) {
  TiffFile& file = self(handle);
  const std::uint64_t left = file.size() - std::min(file.position_, file.size());
  const std::uint64_t bytes = std::min(left, static_cast<std::uint64_t>(count));
  if (bytes > 0) std::memcpy(to, file.file_.data() + file.position_, bytes);
  file.position_ += bytes;
  return static_cast<tmsize_t>(bytes);
}

toff_t TiffFile::seek(thandle_t handle, toff_t offset, int origin) {
  TiffFile& file = self(handle);
  const std::uint64_t start = origin == SEEK_SET ? 0 : origin == SEEK_CUR ? file.position_ : file.size();
  return file.position_ = start + offset;
}

int TiffFile::map(thandle_t handle, void** start, toff_t* size) {
  *start = const_cast<std::byte*>(self(handle).file_.data());  // open for reading, libtiff only reads
  *size = self(handle).size();
  return 1;
}

int TiffFile::on_error(TIFF*, void* file, const char*, const char* format, va_list arguments) {
  std::array<char, 200>& error = static_cast<TiffFile*>(file)->error_;
  if (error[0] != '\0') return 1;
  std::vsnprintf(error.data(), error.size(), format, arguments);
  std::replace_if(
      error.begin(), std::find(error.begin(), error.end(), '\0'),
      [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');  // some have several lines
  return 1;                                                        // it has been dealt with
}

TiffFile::TiffFile(std::span<const std::byte> file) : file_(file) {
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  if (options == nullptr) throw std::bad_alloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), static_cast<tmsize_t>(kMaxTiffBlock));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), on_error, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), on_tiff_warning, nullptr);
  const auto size = [](thandle_t handle) -> toff_t { return self(handle).size(); };
  tiff_ = TIFFClientOpenExt("", "r", this, read, write_nothing, seek, close_nothing, size, map, unmap_nothing,
                            options.get());
  if (tiff_ == nullptr) fail();
  error_[0] = '\0';  // what was wrong and did not matter explains no later failure
}

TiffFile::~TiffFile() {
  if (tiff_ != nullptr) TIFFClose(tiff_);
}

void TiffFile::fail() const {
  if (error_[0] == '\0') throw DecodeError("the file is damaged or cut short");
  throw DecodeError("the file is damaged or cut short (" + std::string(error_.data()) + ")");
}

}  // namespace knotreel::image
