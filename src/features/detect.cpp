// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/detect.h"

#include <cmath>
#include <string>

#include "features/draw.h"
#include "features/extract.h"
#include "features/gradient.h"
#include "features/stepped.h"
#include "knotreel/base/error.h"
#include "knotreel/features/scale.h"

namespace knotreel::features {
namespace {

void require(bool condition, const std::string& what) {
  if (!condition) throw Error(ErrorKind::kInvalidArgument, what);
}

void check(const image::Image& image, const DetectOptions& options) {
  require(image.width > 0 && image.height > 0 && image.channels >= 1 && image.channels <= 4 &&
              image.samples.size() == image.pixel_count() * std::uint64_t(image.channels),
          "the picture's size and its samples do not agree");
  require(options.smoothing >= 0 && options.smoothing <= 10, "smoothing must be in 0..10 pixels");
  require(options.edge_threshold > 0 && std::isfinite(options.edge_threshold),
          "the edge threshold must be positive");
  require(options.anchor_threshold >= 0 && std::isfinite(options.anchor_threshold),
          "the anchor threshold must not be negative");
  require(options.min_length >= 0 && std::isfinite(options.min_length),
          "the least length must not be negative");
  require(options.min_weight >= 0 && std::isfinite(options.min_weight),
          "the least weight must not be negative");
  require(options.max_blur >= 0 && std::isfinite(options.max_blur), "the largest blur must not be negative");
}

}  // namespace

FeatureChains detect_features(const image::Image& image, const DetectOptions& options) {
  check(image, options);
  const GradientField field = make_gradient_field(image, options);
  FeatureChains chains = extract_chains(draw_edges(field, options), field);
  mark_stepped(image, chains);
  return chains;
}

void mark_stepped(const image::Image& picture, FeatureChains& chains) {
  const int scale = scale_of(chains, picture);
  for (Chain& chain : chains.chains) chain.stepped = is_stepped(picture, chain, scale);
}

}  // namespace knotreel::features
