// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <utility>

#include "codec.h"
#include "tiff_colours.h"
#include "tiff_file.h"
#include "tiff_layout.h"
#include "tiff_samples.h"

// Why not by OpenCV: docs/decisions/0002-png-and-pnm-without-opencv.md.
namespace knotreel::image {
namespace {

/// Strips and tiles alike: a strip is a tile as wide as the picture.
struct Blocks {
  bool tiled = false;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::size_t row_bytes = 0;
  std::size_t bytes = 0;  ///< of one; a planar picture has one per sample at each place
};

Blocks blocks_of(const TiffFile& file, const TiffLayout& layout) {
  TIFF* tiff = file.handle();
  Blocks blocks;
  blocks.tiled = TIFFIsTiled(tiff) != 0;
  if (blocks.tiled) {
    blocks.width = file.tag<std::uint32_t>(TIFFTAG_TILEWIDTH, 0);
    blocks.height = file.tag<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
  } else {
    blocks.width = layout.width;
    blocks.height = std::min(file.tag<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, layout.height), layout.height);
  }
  blocks.row_bytes = static_cast<std::size_t>(blocks.tiled ? TIFFTileRowSize(tiff) : TIFFScanlineSize(tiff));
  blocks.bytes = static_cast<std::size_t>(blocks.tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff));
  if (blocks.width == 0 || blocks.height == 0 || blocks.bytes == 0) file.fail();
  return blocks;
}

/// What lies in no file is told before memory is taken for a picture of it.
void check_blocks_are_there(const TiffFile& file) {
  TIFF* tiff = file.handle();
  const std::uint32_t count = TIFFIsTiled(tiff) != 0 ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t bytes = TIFFGetStrileByteCount(tiff, i);
    const std::uint64_t offset = TIFFGetStrileOffset(tiff, i);
    if (bytes == 0 || offset > file.size() || bytes > file.size() - offset)
      throw DecodeError("the file is damaged or cut short");
  }
}

/// Reads the strips or tiles one by one and puts what they hold in its place.
class BlockReader {
 public:
  BlockReader(const TiffFile& file, const TiffLayout& layout)
      : file_(file), layout_(layout), converter_(file, layout), blocks_(blocks_of(file, layout)) {
    for (int c = 0; c < layout.colour_samples; ++c) wanted_.push_back(c);
    if (layout.alpha > 0) wanted_.push_back(layout.alpha);
    check_blocks_are_there(file);
    const std::uint64_t at_a_place = blocks_.bytes * buffers();
    if (at_a_place > kMaxTiffBlock) throw DecodeError("it is stored in pieces that are too large");
    stored_ = std::make_unique_for_overwrite<std::byte[]>(at_a_place);
    numbers_.resize(wanted_.size() * std::min(blocks_.width, layout.width));
  }

  Decoded read() {
    Decoded decoded{{}, converter_.samples()};
    for (std::uint32_t y = 0; y < layout_.height; y += blocks_.height) {
      for (std::uint32_t x = 0; x < layout_.width; x += blocks_.width) {
        read_blocks(x, y);
        if (decoded.image.samples.empty())  // not before something could be read
          decoded.image = make_image(static_cast<int>(layout_.width), static_cast<int>(layout_.height),
                                     converter_.channels());
        place(x, y, decoded.image);
      }
    }
    return decoded;
  }

 private:
  std::size_t buffers() const { return layout_.planar ? wanted_.size() : 1; }
  std::uint32_t rows_at(std::uint32_t y) const { return std::min(blocks_.height, layout_.height - y); }

  void read_blocks(std::uint32_t x, std::uint32_t y) {
    for (std::size_t i = 0; i < buffers(); ++i) {
      const auto plane = static_cast<std::uint16_t>(layout_.planar ? wanted_[i] : 0);
      const tmsize_t got = read_block(x, y, plane, stored_.get() + i * blocks_.bytes);
      if (got < static_cast<tmsize_t>(rows_at(y) * blocks_.row_bytes)) file_.fail();
    }
  }

  tmsize_t read_block(std::uint32_t x, std::uint32_t y, std::uint16_t plane, std::byte* to) {
    TIFF* tiff = file_.handle();
    const auto bytes = static_cast<tmsize_t>(blocks_.bytes);
    return blocks_.tiled ? TIFFReadEncodedTile(tiff, TIFFComputeTile(tiff, x, y, 0, plane), to, bytes)
                         : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, y, plane), to, bytes);
  }

  void place(std::uint32_t x, std::uint32_t y, Image& image) {
    const std::size_t columns = std::min(blocks_.width, layout_.width - x);
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::uint32_t row = 0; row < rows_at(y); ++row) {
      unpack_row(row, columns);
      float* to = image.row(static_cast<int>(y + row)).data() + x * channels;
      for (std::size_t i = 0; i < columns; ++i)
        converter_.convert(numbers_.data() + i * wanted_.size(), to + i * channels);
    }
  }

  /// From the stored row of each wanted sample to numbers, pixel by pixel.
  void unpack_row(std::size_t row, std::size_t columns) {
    const UnpackSamples unpack = tiff_unpacker(layout_.bits, layout_.floats);
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const std::byte* from =
          stored_.get() + (layout_.planar ? i : 0) * blocks_.bytes + row * blocks_.row_bytes;
      const SamplesOfRow samples = layout_.planar ? SamplesOfRow{}
                                                  : SamplesOfRow{static_cast<std::size_t>(wanted_[i]),
                                                                 static_cast<std::size_t>(layout_.samples)};
      unpack(from, samples, columns, numbers_.data() + i, wanted_.size());
    }
  }

  const TiffFile& file_;
  TiffLayout layout_;
  TiffConverter converter_;
  Blocks blocks_;
  std::vector<int> wanted_;  ///< samples: the colours, then alpha
  std::unique_ptr<std::byte[]> stored_;
  std::vector<double> numbers_;
};

/// Leaves the first page.
bool has_more_pages(const TiffFile& file) {
  while (TIFFReadDirectory(file.handle()) != 0) {
    constexpr std::uint32_t kNoPage = FILETYPE_REDUCEDIMAGE | FILETYPE_MASK;
    if ((file.tag<std::uint32_t>(TIFFTAG_SUBFILETYPE, 0) & kNoPage) == 0) return true;
  }
  return false;
}

/// By libtiff's own reader, which knows all kinds of YCbCr, with fewer samples of colour and in old JPEGs.
Decoded read_ycbcr(const TiffFile& file, const TiffLayout& layout) {
  std::array<char, 1024> why{};
  if (TIFFRGBAImageOK(file.handle(), why.data()) == 0)
    throw DecodeError("it is a TIFF that is not read (" + std::string(why.data()) + ")");
  const std::size_t pixels = std::size_t{layout.width} * layout.height;
  const auto raster = std::make_unique_for_overwrite<std::uint32_t[]>(pixels);
  // Its turning is not asked for, since that of the other kinds is ours.
  if (TIFFReadRGBAImageOriented(file.handle(), layout.width, layout.height, raster.get(), layout.orientation,
                                1) == 0)
    file.fail();
  Decoded decoded{make_image(static_cast<int>(layout.width), static_cast<int>(layout.height), 3),
                  SampleType::u8};
  float* to = decoded.image.samples.data();
  for (std::size_t i = 0; i < pixels; ++i, to += 3) {
    to[0] = static_cast<float>(TIFFGetR(raster[i]));
    to[1] = static_cast<float>(TIFFGetG(raster[i]));
    to[2] = static_cast<float>(TIFFGetB(raster[i]));
  }
  return decoded;
}

/// The picture as it is meant to be seen, by the orientations of TIFF and EXIF.
Image turned(Image image, int orientation) {
  if (orientation <= ORIENTATION_TOPLEFT || orientation > ORIENTATION_LEFTBOT) return image;
  const bool from_right = orientation == ORIENTATION_TOPRIGHT || orientation == ORIENTATION_BOTRIGHT ||
                          orientation == ORIENTATION_RIGHTTOP || orientation == ORIENTATION_RIGHTBOT;
  const bool from_bottom = orientation == ORIENTATION_BOTRIGHT || orientation == ORIENTATION_BOTLEFT ||
                           orientation == ORIENTATION_RIGHTBOT || orientation == ORIENTATION_LEFTBOT;
  const bool rows_are_columns = orientation >= ORIENTATION_LEFTTOP;
  Image seen = rows_are_columns ? make_image(image.height, image.width, image.channels)
                                : make_image(image.width, image.height, image.channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      int u = rows_are_columns ? y : x;
      int v = rows_are_columns ? x : y;
      if (from_right) u = seen.width - 1 - u;
      if (from_bottom) v = seen.height - 1 - v;
      for (int c = 0; c < image.channels; ++c) seen.at(u, v, c) = image.at(x, y, c);
    }
  }
  return seen;
}

}  // namespace

Decoded decode_tiff(std::span<const std::byte> bytes) {
  const TiffFile file(bytes);
  const TiffLayout layout = tiff_layout(file);
  Decoded decoded =
      layout.colours == TiffColours::kYcbcr ? read_ycbcr(file, layout) : BlockReader(file, layout).read();
  decoded.image = turned(std::move(decoded.image), layout.orientation);
  decoded.more_pages = has_more_pages(file);
  return decoded;
}

}  // namespace knotreel::image
