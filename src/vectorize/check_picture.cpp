// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/check_picture.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "knotreel/base/error.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::vectorize {

void check_picture(const image::Image& picture) {
  const auto refuse = [](const char* what) { throw Error(ErrorKind::kInvalidArgument, what); };
  if (picture.width < 1 || picture.height < 1) refuse("cannot vectorize a picture without pixels");
  image::check_image(picture);
  // By the bits, all of them: each frame of a video is looked at, and a loop that may end early is slow.
  constexpr std::uint32_t kInfinity = 0x7F800000, kWithoutSign = 0x7FFFFFFF;
  std::uint32_t largest = 0;
  for (const float sample : picture.samples)
    largest = std::max(largest, std::bit_cast<std::uint32_t>(sample) & kWithoutSign);
  if (largest >= kInfinity) refuse("cannot vectorize a picture with samples that are not finite");
  if (largest > std::bit_cast<std::uint32_t>(kLargestSample))
    refuse("cannot vectorize a picture with samples of more than 10000 times white");
}

}  // namespace knotreel::vectorize
