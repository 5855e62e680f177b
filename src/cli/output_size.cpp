#include "cli/output_size.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

constexpr int kMaxSide = 1'000'000;

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

Size given_size(const std::string& text) {
  const Size size = parse_size("--size", text);
  if (size.width > kMaxSide || size.height > kMaxSide) {
    refuse("--size " + text + " is more than " + std::to_string(kMaxSide) + " pixels on a side");
  }
  return size;
}

}  // namespace

Size output_size(double scale, const std::string& size, int width, int height) {
  if (!size.empty()) return given_size(size);
  if (!std::isfinite(scale) || scale <= 0) refuse("--scale takes a number above 0");
  const double scaled_width = std::max(1.0, std::round(width * scale));
  const double scaled_height = std::max(1.0, std::round(height * scale));
  if (scaled_width > kMaxSide || scaled_height > kMaxSide) {
    refuse("--scale gives more than " + std::to_string(kMaxSide) + " pixels on a side");
  }
  return {static_cast<int>(scaled_width), static_cast<int>(scaled_height)};
}

Rect parse_crop(const std::string& text, Size whole) {
  const Rect crop = parse_rect("--crop", text);
  if (crop.x > whole.width - crop.width || crop.y > whole.height - crop.height) {
    throw Error(ErrorKind::kInvalidArgument, "--crop " + text + " is not inside the picture of " +
                                                 std::to_string(whole.width) + "x" +
                                                 std::to_string(whole.height) + " pixels");
  }
  return crop;
}

}  // namespace knotreel::cli
