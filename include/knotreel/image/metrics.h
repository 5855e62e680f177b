// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// How far two pictures are apart, as they are seen: with alpha on black and on white, which count the same.
struct ImageMetrics {
  /// Mean over pixels of the Euclidean length of the colour error, scale 0..255.
  double mec = 0;
  /// Root mean square of the colour error over pixels and colour channels, colour in [0,1].
  double rmse = 0;
  /// Peak signal-to-noise ratio in dB on samples rounded to 8 bits, all channels pooled; positive infinity
  /// for equal samples.
  double psnr = 0;
  /// Structural similarity of the luma (Rec. 601 weights; grey is its own luma), at most 1 [Wang04]: Gaussian
  /// window of 11 x 11 and sigma 1.5, K1 = 0.01, K2 = 0.03, L = 255, mean over the windows that lie inside
  /// the picture. In a picture narrower or lower than 11 pixels, the window shrinks to the largest odd size.
  /// 0 if it was not asked for.
  double ssim = 0;
};

/// What to find; SSIM takes three quarters of the time.
enum class Figures { kAll, kWithoutSsim };

/// Compares two pictures of one size. Different channels are widened to the larger set first: grey to RGB,
/// no alpha to opaque. Alpha is cut to 0..255; colours that it hides do not count.
/// @throws Error{kInvalidArgument} if the sizes differ or a picture is empty.
/// All threads are used; the result does not depend on their number.
ImageMetrics compare_images(const Image& a, const Image& b, Figures figures = Figures::kAll);

}  // namespace knotreel::image
