// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/output_size.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

constexpr int kMaxSide = 1'000'000;

[[noreturn]] void refuse_size(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

Size given_size(const std::string& text) {
  const Size size = parse_size("--size", text);
  if (size.width > kMaxSide || size.height > kMaxSide) {
    refuse_size("--size " + text + " is more than " + std::to_string(kMaxSide) + " pixels on a side");
  }
  return size;
}

Size with_sides(Size size, const Turn& turn) {
  return turn.swaps_sides() ? Size{size.height, size.width} : size;
}

}  // namespace

void check_output_size(double scale, const std::string& size) {
  if (!size.empty()) {
    given_size(size);
  } else if (!std::isfinite(scale) || scale <= 0) {
    refuse_size("--scale takes a number above 0");
  }
}

Size output_size(double scale, const std::string& size, int width, int height, const Turn& turn) {
  check_output_size(scale, size);
  if (!size.empty()) return with_sides(given_size(size), turn);
  const double scaled_width = std::max(1.0, std::round(width * scale));
  const double scaled_height = std::max(1.0, std::round(height * scale));
  if (scaled_width > kMaxSide || scaled_height > kMaxSide) {
    refuse_size("--scale gives more than " + std::to_string(kMaxSide) + " pixels on a side");
  }
  return {static_cast<int>(scaled_width), static_cast<int>(scaled_height)};
}

Rect parse_crop(const std::string& text, Size whole, const Turn& turn) {
  const Rect crop = parse_rect("--crop", text);
  const Size shown = with_sides(whole, turn);
  if (crop.x > shown.width - crop.width || crop.y > shown.height - crop.height) {
    throw Error(ErrorKind::kInvalidArgument, "--crop " + text + " is not inside the picture of " +
                                                 std::to_string(shown.width) + "x" +
                                                 std::to_string(shown.height) + " pixels");
  }
  // Its sides, counted from where the pixels drawn first are shown.
  const int x = turn.right_x + turn.down_x > 0 ? crop.x : shown.width - crop.x - crop.width;
  const int y = turn.right_y + turn.down_y > 0 ? crop.y : shown.height - crop.y - crop.height;
  if (turn.swaps_sides()) return {y, x, crop.height, crop.width};
  return {x, y, crop.width, crop.height};
}

}  // namespace knotreel::cli
