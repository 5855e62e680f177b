// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"

/// A small painter for the pictures of --debug-dir.
namespace knotreel::cli::debug {

struct Colour {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;

  friend bool operator==(const Colour&, const Colour&) = default;
};

/// `share` of b and the rest of a.
Colour mix(Colour a, Colour b, double share);

/// An RGB picture, some times as large as the plane that is drawn on it: points are given in pixels of the
/// plane (knotreel/base/vec2.h), widths and radii in pixels of the canvas. What lies outside is cut off.
class Canvas {
 public:
  /// @param scale canvas pixels per pixel of the plane, 1 or more.
  /// @param footer canvas pixels below the plane.
  Canvas(int plane_width, int plane_height, int scale, Colour background, int footer = 0);

  int width() const { return width_; }
  int height() const { return height_; }
  int scale() const { return scale_; }
  /// Row-major, three bytes per pixel of the canvas.
  std::span<const std::uint8_t> rgb() const { return rgb_; }

  /// Fills the square of one pixel of the plane.
  void pixel(int x, int y, Colour colour);
  /// Fills a rectangle of canvas pixels.
  void box(int left, int top, int width, int height, Colour colour);
  /// A line with round ends; opacity in 0..1.
  void line(Vec2 from, Vec2 to, double width, Colour colour, double opacity = 1);
  void disc(Vec2 centre, double radius, Colour colour);
  /// Digits and full stops in canvas pixels, 6 x `size` wide and 7 x `size` high each.
  void number(int left, int top, std::string_view digits, int size, Colour colour);

  /// @throws Error{kOutput} if the file cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  void blend(int x, int y, Colour colour, double opacity);

  int width_;
  int height_;
  int scale_;
  std::vector<std::uint8_t> rgb_;
};

/// How many times a picture is enlarged so that fractions of a pixel show, but the result stays viewable.
int debug_scale(int width, int height);

/// The picture on a canvas, its pixels as squares; alpha lies on white.
/// @param dim share of white mixed in, 0..1.
/// @param saturation 1: all colours stay, 0: grey.
Canvas enlarged(const image::Image& picture, double dim = 0, double saturation = 1);
/// The same at a scale of choice.
Canvas enlarged_by(int scale, const image::Image& picture, double dim = 0, double saturation = 1);

}  // namespace knotreel::cli::debug
