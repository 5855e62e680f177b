// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>
#include <string_view>

#include "codec.h"

// PBM, PGM, PPM (plain and raw), PAM and PFM: http://netpbm.sourceforge.net/doc/. Read here rather than by
// OpenCV because that has no grey + alpha and no maxval other than 255 and 65535.
namespace knotreel::image {
namespace {

/// Walks over the text part of a file.
class Scanner {
 public:
  explicit Scanner(std::span<const std::byte> file)
      : text_(reinterpret_cast<const char*>(file.data()), file.size()) {}

  void skip(std::size_t count) { position_ = std::min(position_ + count, text_.size()); }

  /// The next word between blanks; comments from # to the end of the line count as blank.
  std::string_view word() {
    skip_blank();
    const std::size_t start = position_;
    while (position_ < text_.size() && !is_blank(text_[position_])) ++position_;
    if (start == position_) throw DecodeError("the file is cut short");
    return text_.substr(start, position_ - start);
  }

  unsigned number(unsigned largest) {
    const std::string_view digits = word();
    unsigned value = 0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (status != std::errc() || end != digits.data() + digits.size() || value > largest)
      throw DecodeError("its header is damaged");
    return value;
  }

  /// The next digit 0 or 1 of a plain PBM, where blanks between digits are optional.
  bool bit() {
    skip_blank();
    if (position_ == text_.size()) throw DecodeError("the file is cut short");
    const char c = text_[position_++];
    if (c != '0' && c != '1') throw DecodeError("it holds something other than 0 and 1");
    return c == '1';
  }

  /// Refuses a header that promises more than the rest of the file can hold, before memory is taken for it.
  void expect(std::uint64_t bytes) const {
    if (text_.size() - position_ < bytes) throw DecodeError("the file is cut short");
  }

  /// The binary part: after exactly one blank.
  std::span<const std::byte> binary(std::uint64_t size) {
    skip(1);
    expect(size);
    return std::as_bytes(std::span(text_.substr(position_, size)));
  }

 private:
  static bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
  void skip_blank() {
    while (position_ < text_.size()) {
      if (text_[position_] == '#') {
        while (position_ < text_.size() && text_[position_] != '\n') ++position_;
      } else if (is_blank(text_[position_])) {
        ++position_;
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

constexpr unsigned kMaxSide = 0x7fffffff;

struct Header {
  unsigned width = 0;
  unsigned height = 0;
  unsigned channels = 0;
  unsigned maxval = 0;
};

float sample_of(unsigned value, const Header& header) {
  return static_cast<float>(255.0 * std::min(value, header.maxval) / header.maxval);
}

Image image_for(const Header& header) {
  return make_image(static_cast<int>(header.width), static_cast<int>(header.height),
                    static_cast<int>(header.channels));
}

void check(const Header& header) {
  check_size(header.width, header.height);
  if (header.channels < 1 || header.channels > 4) throw DecodeError("only 1 to 4 channels are supported");
  if (header.maxval < 1) throw DecodeError("its header is damaged");
}

Decoded read_integers(Scanner& scanner, const Header& header) {
  const std::uint64_t count = std::uint64_t{header.width} * header.height * header.channels;
  const bool wide = header.maxval > 255;
  const auto bytes = scanner.binary(wide ? 2 * count : count);
  Decoded decoded{image_for(header), wide ? SampleType::u16 : SampleType::u8};
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned value =
        wide ? std::to_integer<unsigned>(bytes[2 * i]) << 8 | std::to_integer<unsigned>(bytes[2 * i + 1])
             : std::to_integer<unsigned>(bytes[i]);
    decoded.image.samples[i] = sample_of(value, header);
  }
  return decoded;
}

Decoded read_plain(Scanner& scanner, const Header& header) {
  scanner.expect(2 * std::uint64_t{header.width} * header.height *
                 header.channels);  // a blank and a digit each
  Decoded decoded{image_for(header), header.maxval > 255 ? SampleType::u16 : SampleType::u8};
  for (float& sample : decoded.image.samples) sample = sample_of(scanner.number(header.maxval), header);
  return decoded;
}

Decoded read_plain_bits(Scanner& scanner, const Header& header) {
  scanner.expect(std::uint64_t{header.width} * header.height);
  Decoded decoded{image_for(header), SampleType::u8};
  for (float& sample : decoded.image.samples) sample = scanner.bit() ? 0.0F : 255.0F;  // 1 is black
  return decoded;
}

Decoded read_bits(Scanner& scanner, const Header& header) {
  const std::size_t row_bytes = (std::size_t{header.width} + 7) / 8;
  const auto bytes = scanner.binary(std::uint64_t{row_bytes} * header.height);
  Decoded decoded{image_for(header), SampleType::u8};
  for (int y = 0; y < decoded.image.height; ++y) {
    for (int x = 0; x < decoded.image.width; ++x) {
      const auto eight = std::to_integer<unsigned>(bytes[std::size_t(y) * row_bytes + std::size_t(x) / 8]);
      decoded.image.at(x, y, 0) = (eight >> (7 - x % 8) & 1) != 0 ? 0.0F : 255.0F;
    }
  }
  return decoded;
}

Decoded read_pnm(Scanner& scanner, char kind) {
  Header header;
  header.width = scanner.number(kMaxSide);
  header.height = scanner.number(kMaxSide);
  header.channels = kind == '3' || kind == '6' ? 3 : 1;
  header.maxval = kind == '1' || kind == '4' ? 1 : scanner.number(65535);
  check(header);
  switch (kind) {
    case '1':
      return read_plain_bits(scanner, header);
    case '2':
    case '3':
      return read_plain(scanner, header);
    case '4':
      return read_bits(scanner, header);
    default:
      return read_integers(scanner, header);
  }
}

Decoded read_pam(Scanner& scanner) {
  Header header;
  for (std::string_view key = scanner.word(); key != "ENDHDR"; key = scanner.word()) {
    if (key == "WIDTH") {
      header.width = scanner.number(kMaxSide);
    } else if (key == "HEIGHT") {
      header.height = scanner.number(kMaxSide);
    } else if (key == "DEPTH") {
      header.channels = scanner.number(65535);
    } else if (key == "MAXVAL") {
      header.maxval = scanner.number(65535);
    } else if (key == "TUPLTYPE") {
      scanner.word();  // the depth says it all
    } else {
      throw DecodeError("its header is damaged");
    }
  }
  check(header);
  return read_integers(scanner, header);
}

Decoded read_pfm(Scanner& scanner, char kind) {
  Header header{.width = scanner.number(kMaxSide),
                .height = scanner.number(kMaxSide),
                .channels = kind == 'F' ? 3U : 1U,
                .maxval = 1};
  check(header);
  // A negative scale means little endian; its size is a unit that nobody uses.
  const bool little = scanner.word().starts_with('-');
  const auto bytes = scanner.binary(std::uint64_t{header.width} * header.height * header.channels * 4);
  Decoded decoded{image_for(header), SampleType::f32};
  Image& image = decoded.image;
  for (int y = 0; y < image.height; ++y) {
    const auto row = image.row(image.height - 1 - y);  // stored from bottom to top
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::uint32_t bits;
      std::memcpy(&bits, bytes.data() + (std::size_t(y) * row.size() + i) * 4, 4);
      if (little != (std::endian::native == std::endian::little)) bits = __builtin_bswap32(bits);
      row[i] = 255.0F * std::bit_cast<float>(bits);
    }
  }
  return decoded;
}

}  // namespace

Decoded decode_pnm(std::span<const std::byte> file) {
  Scanner scanner(file);
  const char kind = static_cast<char>(file[1]);
  scanner.skip(2);
  if (kind == '7') return read_pam(scanner);
  if (kind == 'f' || kind == 'F') return read_pfm(scanner, kind);
  return read_pnm(scanner, kind);
}

}  // namespace knotreel::image
