// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/canvas.h"

#include <algorithm>
#include <cmath>

#include "cli/debug/digits.h"
#include "knotreel/image/write_image.h"

namespace knotreel::cli::debug {
namespace {

std::uint8_t to_byte(double v) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
}

/// The interval of whole numbers that [low, high] touches, cut to [0, size).
struct Interval {
  int begin;
  int end;
  Interval(double low, double high, int size)
      : begin(static_cast<int>(std::clamp(std::floor(low), 0.0, double(size)))),
        end(static_cast<int>(std::clamp(std::ceil(high) + 1, 0.0, double(size)))) {}
};

Vec2 swapped(Vec2 v) {
  return {v.y, v.x};
}

}  // namespace

Colour mix(Colour a, Colour b, double share) {
  const auto channel = [share](std::uint8_t u, std::uint8_t v) {
    return to_byte(double(u) + share * (double(v) - double(u)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

Canvas::Canvas(int plane_width, int plane_height, int scale, Colour background, int footer)
    : width_(plane_width * scale),
      height_(plane_height * scale + footer),
      scale_(scale),
      rgb_(std::size_t(width_) * std::size_t(height_) * 3) {
  box(0, 0, width_, height_, background);
}

void Canvas::pixel(int x, int y, Colour colour) {
  box(x * scale_, y * scale_, scale_, scale_, colour);
}

void Canvas::box(int left, int top, int width, int height, Colour colour) {
  for (int y = std::max(0, top); y < std::min(height_, top + height); ++y) {
    for (int x = std::max(0, left); x < std::min(width_, left + width); ++x) blend(x, y, colour, 1);
  }
}

void Canvas::line(Vec2 from, Vec2 to, double width, Colour colour, double opacity) {
  Vec2 a = double(scale_) * from;
  Vec2 b = double(scale_) * to;
  // Along x, row by row otherwise: only pixels close to the line are looked at.
  const bool steep = std::abs(b.y - a.y) > std::abs(b.x - a.x);
  if (steep) {
    a = swapped(a);
    b = swapped(b);
  }
  if (a.x > b.x) std::swap(a, b);
  const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0;
  const double reach = width / 2 + 0.5;
  const double across = reach * std::sqrt(1 + slope * slope);
  const int columns = steep ? height_ : width_;
  const int rows = steep ? width_ : height_;
  const Interval along(a.x - reach, b.x + reach, columns);
  for (int x = along.begin; x < along.end; ++x) {
    const double middle = a.y + slope * (std::clamp(x + 0.5, a.x, b.x) - a.x);
    const Interval near(middle - across - 1, middle + across + 1, rows);
    for (int y = near.begin; y < near.end; ++y) {
      const double covered = reach - distance_to_segment({x + 0.5, y + 0.5}, a, b);
      if (covered <= 0) continue;
      blend(steep ? y : x, steep ? x : y, colour, opacity * std::min(1.0, covered));
    }
  }
}

void Canvas::disc(Vec2 centre, double radius, Colour colour) {
  line(centre, centre, 2 * radius, colour);
}

void Canvas::number(int left, int top, std::string_view digits, int size, Colour colour) {
  for (const char c : digits) {
    const Glyph& glyph = digit_glyph(c);
    for (int y = 0; y < kGlyphHeight; ++y) {
      for (int x = 0; x < kGlyphWidth; ++x) {
        if (glyph[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] != '#') continue;
        box(left + x * size, top + y * size, size, size, colour);
      }
    }
    left += (kGlyphWidth + 1) * size;
  }
}

void Canvas::blend(int x, int y, Colour colour, double opacity) {
  std::uint8_t* at = &rgb_[(std::size_t(y) * std::size_t(width_) + std::size_t(x)) * 3];
  const Colour mixed = opacity < 1 ? mix({at[0], at[1], at[2]}, colour, opacity) : colour;
  at[0] = mixed.r;
  at[1] = mixed.g;
  at[2] = mixed.b;
}

void Canvas::write(const std::filesystem::path& path) const {
  image::ImageFileSpec spec;
  spec.width = width_;
  spec.height = height_;
  spec.channels = 3;
  const auto writer = image::open_image_writer(path, spec);
  std::vector<float> row(std::size_t(width_) * 3);
  for (int y = 0; y < height_; ++y) {
    const auto* begin = &rgb_[std::size_t(y) * row.size()];
    std::copy(begin, begin + row.size(), row.begin());
    writer->write(row, 1);
  }
  writer->finish();
}

int debug_scale(int width, int height) {
  const int longest = std::max(width, height);
  const int most = longest <= 128 ? 8 : 4;
  // Pictures over 2500 pixels show fractions of pixels to nobody who sees them whole.
  return longest > 2500 ? 1 : std::clamp(2800 / longest, 2, most);
}

Canvas enlarged(const image::Image& picture, double dim, double saturation) {
  return enlarged_by(debug_scale(picture.width, picture.height), picture, dim, saturation);
}

Canvas enlarged_by(int scale, const image::Image& picture, double dim, double saturation) {
  constexpr Colour kWhite{255, 255, 255};
  Canvas canvas(picture.width, picture.height, scale, kWhite);
  const bool colours = picture.colour_channels() == 3;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto at = [&](int c) { return double(picture.at(x, y, c)); };
      const Colour own{to_byte(at(0)), to_byte(at(colours ? 1 : 0)), to_byte(at(colours ? 2 : 0))};
      const std::uint8_t luma = to_byte(0.299 * own.r + 0.587 * own.g + 0.114 * own.b);
      const double alpha = picture.has_alpha() ? std::clamp(at(picture.channels - 1) / 255, 0.0, 1.0) : 1;
      canvas.pixel(x, y, mix(kWhite, mix({luma, luma, luma}, own, saturation), alpha * (1 - dim)));
    }
  }
  return canvas;
}

}  // namespace knotreel::cli::debug
