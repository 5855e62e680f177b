// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/features/flat_share.h"
#include "knotreel/image/image.h"
#include "vectorize/draft.h"
#include "vectorize/mapped_picture.h"
#include "vectorize/samples.h"

/// Pictures, above all drawings, are mapped, and their knots placed, on pixels of half the size, where
/// strokes of one or two pixels have two sides (docs/decisions/0044). What is found there is halved before
/// the last fit, which is to the picture itself.
namespace knotreel::vectorize {

/// Whether a picture is to be so, by the options and what is in it.
bool wants_fine_grid(const image::Image& picture, const Options& options);

/// The settings without what is for clean pictures only, if this one is not: there, faint edges are noise.
Options suited_to(const image::Image& picture, Options options);
/// @param differences of the picture.
Options suited_to(const image::Image& picture, const features::SecondDifferences& differences,
                  Options options);

/// The same settings in pixels of half the size.
Options on_fine_grid(Options options);

/// The picture with what was found on the fine grid; both outlive it.
class Halved {
 public:
  Halved(const MappedPicture& fine, const image::Image& picture);
  Halved(const Halved&) = delete;
  Halved& operator=(const Halved&) = delete;

  Samples& samples() { return samples_; }

 private:
  MappedPicture mapped_;
  Samples samples_;
};

/// Features without pixels (map_curves()), in the picture itself.
MappedPicture halved_features(const MappedPicture& fine);

/// The same surface over the domain of the picture.
Draft halved(const Draft& fine);

/// Values of the pixels of a picture for those of half the size.
std::vector<float> on_fine_pixels(const std::vector<float>& values, int width);

}  // namespace knotreel::vectorize
