// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiffio.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "codec.h"

namespace knotreel::image {
namespace {

/// A TIFF in memory that is being written: libtiff goes back to where it has written already, which pipes
/// cannot. No exception may cross its C frames, so a failure is kept.
class TiffInMemory {
 public:
  explicit TiffInMemory(bool big) {
    const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                               TIFFOpenOptionsFree);
    if (options == nullptr) throw std::bad_alloc();
    const auto say_nothing = [](TIFF*, void*, const char*, const char*, va_list) { return 1; };
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), say_nothing, nullptr);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), say_nothing, nullptr);
    const auto size = [](thandle_t handle) -> toff_t { return self(handle).bytes_.size(); };
    const auto close = [](thandle_t) { return 0; };
    tiff_ = TIFFClientOpenExt("", big ? "w8" : "w", this, read, write, seek, close, size, nullptr, nullptr,
                              options.get());
    if (tiff_ == nullptr) throw std::bad_alloc();
  }
  ~TiffInMemory() {
    if (tiff_ != nullptr) TIFFClose(tiff_);
  }
  TiffInMemory(const TiffInMemory&) = delete;
  TiffInMemory& operator=(const TiffInMemory&) = delete;

  TIFF* handle() const { return tiff_; }

  /// All of it, once everything has been written.
  /// @throws std::bad_alloc if it had no room.
  const std::vector<std::byte>& close() {
    TIFFClose(tiff_);
    tiff_ = nullptr;
    if (is_full_) throw std::bad_alloc();
    return bytes_;
  }

 private:
  static TiffInMemory& self(thandle_t handle) { return *static_cast<TiffInMemory*>(handle); }

  static tmsize_t read(thandle_t, void*, tmsize_t) { return 0; }

  static tmsize_t write(thandle_t handle, void* from, tmsize_t count) {
    TiffInMemory& file = self(handle);
    const auto size = static_cast<std::size_t>(count);
    try {
      if (file.bytes_.size() < file.position_ + size) file.bytes_.resize(file.position_ + size);
    } catch (const std::bad_alloc&) {
      file.is_full_ = true;
      return 0;
    }
    std::memcpy(file.bytes_.data() + file.position_, from, size);
    file.position_ += size;
    return count;
  }

  static toff_t seek(thandle_t handle, toff_t offset, int origin) {
    TiffInMemory& file = self(handle);
    const std::size_t start = origin == SEEK_SET   ? 0
                              : origin == SEEK_CUR ? file.position_
                                                   : file.bytes_.size();
    return file.position_ = start + offset;
  }

  std::vector<std::byte> bytes_;
  std::size_t position_ = 0;
  bool is_full_ = false;
  TIFF* tiff_ = nullptr;
};

int bits_of(SampleType samples) {
  return samples == SampleType::u8 ? 8 : samples == SampleType::u16 ? 16 : 32;
}

/// Whether offsets of 32 bits may not be enough, LZW making noise longer.
bool needs_big_tiff(const ImageFileSpec& spec) {
  const std::uint64_t bytes = std::uint64_t(spec.width) * std::uint64_t(spec.height) *
                              std::uint64_t(spec.channels) * std::uint64_t(bits_of(spec.samples) / 8);
  return bytes > std::uint64_t{1} << 31;
}

/// LZW, which all readers know, in strips.
class TiffWriter final : public CheckedRowWriter {
 public:
  TiffWriter(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec)
      : CheckedRowWriter(std::move(file), spec), tiff_(needs_big_tiff(spec)) {
    set(TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(spec.width));
    set(TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(spec.height));
    set(TIFFTAG_BITSPERSAMPLE, bits_of(spec.samples));
    set(TIFFTAG_SAMPLESPERPIXEL, spec.channels);
    set(TIFFTAG_SAMPLEFORMAT, spec.samples == SampleType::f32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    set(TIFFTAG_PHOTOMETRIC, spec.channels >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    set(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    if (spec.channels % 2 == 0) {
      std::uint16_t alpha = EXTRASAMPLE_UNASSALPHA;
      set(TIFFTAG_EXTRASAMPLES, 1, &alpha);
    }
    set(TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    if (spec.samples != SampleType::f32) set(TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
    set(TIFFTAG_ROWSPERSTRIP, TIFFDefaultStripSize(tiff_.handle(), 0));
    stored_.resize(std::size_t(spec.width) * std::size_t(spec.channels) *
                   std::size_t(bits_of(spec.samples) / 8));
  }

 private:
  template <typename... Values>
  void set(std::uint32_t tag, Values... values) {
    if (TIFFSetField(tiff_.handle(), tag, values...) == 0) fail();
  }

  [[noreturn]] void fail() {
    throw Error(ErrorKind::kOutput, "cannot write " + file().name() + ": the encoder refused the picture");
  }

  /// In the order of bytes of the machine, which is that of the file.
  template <typename Stored, typename Convert>
  void store(std::span<const float> row, Convert convert) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Stored sample = convert(row[i]);
      std::memcpy(stored_.data() + i * sizeof(Stored), &sample, sizeof(Stored));
    }
  }

  void write_row(std::span<const float> row) override {
    switch (spec().samples) {
      case SampleType::u8:
        store<std::uint8_t>(row, to_u8);
        break;
      case SampleType::u16:
        store<std::uint16_t>(row, to_u16);
        break;
      case SampleType::f32:
        store<float>(row, [](float sample) { return sample / 255.0F; });
        break;
    }
    if (TIFFWriteScanline(tiff_.handle(), stored_.data(), static_cast<std::uint32_t>(rows_written()), 0) < 0)
      fail();
  }

  void complete() override {
    if (TIFFFlush(tiff_.handle()) == 0) fail();
    file().write(tiff_.close());
  }

  TiffInMemory tiff_;
  std::vector<std::byte> stored_;  ///< a row
};

}  // namespace

std::unique_ptr<RowWriter> make_tiff_writer(std::unique_ptr<OutputFile> file, const ImageFileSpec& spec) {
  return std::make_unique<TiffWriter>(std::move(file), spec);
}

}  // namespace knotreel::image
