// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/detect.h"

#include <algorithm>
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

/// Whether there is a gradient above a threshold in a cell.
bool has_edge(const GradientField& field, const PixelBox& cell, float least) {
  for (int y = cell.top; y < cell.bottom; ++y) {
    const float* const row = field.magnitude.data() + field.at(0, y);
    if (std::any_of(row + cell.left, row + cell.right, [&](float m) { return m >= least; })) return true;
  }
  return false;
}

/// Of the cells in the window that are wanted.
void mark_edges(const GradientField& field, const PixelBox& window, const DetectOptions& options,
                const CellMask& wanted, CellMask& edges) {
  constexpr int kSide = CellMask::kSide;
  const auto least = float(std::min(options.edge_threshold, options.anchor_threshold));
  for (int top = window.top; top < window.bottom; top += kSide) {
    for (int left = window.left; left < window.right; left += kSide) {
      if (!wanted.at_pixel(left, top)) continue;
      const PixelBox cell{left - window.left, top - window.top,
                          std::min(left + kSide, window.right) - window.left,
                          std::min(top + kSide, window.bottom) - window.top};
      edges.set(left / kSide, top / kSide, has_edge(field, cell, least));
    }
  }
}

}  // namespace

FeatureChains detect_features(const image::Image& image, const DetectOptions& options) {
  check(image, options);
  const GradientField field = make_gradient_field(image, options);
  FeatureChains chains = extract_chains(draw_edges(field, options), field);
  mark_stepped(image, chains);
  return chains;
}

int reach_of_edges(const DetectOptions& options) {
  return reach_of_gradients(options);
}

FeatureChains detect_in_window(const image::Image& part, const PixelBox& window, const DetectOptions& options,
                               const CellMask& wanted, CellMask& edges) {
  check(part, options);
  require(part.width == window.width() && part.height == window.height() &&
              window.left % CellMask::kSide == 0 && window.top % CellMask::kSide == 0,
          "a window of a picture must begin with a cell and have its pixels");
  GradientField field = make_gradient_field(part, options);
  field.origin_x = window.left;
  field.origin_y = window.top;
  field.whole_width = wanted.width();
  field.whole_height = wanted.height();
  mark_edges(field, window, options, wanted, edges);
  FeatureChains chains = extract_chains(draw_edges(field, options), field);
  std::erase_if(chains.chains, [&](const Chain& chain) {
    return !wanted.at_pixel(chain.points.front().x, chain.points.front().y);
  });
  return chains;
}

void mark_stepped(const image::Image& picture, FeatureChains& chains) {
  const int scale = scale_of(chains, picture);
  for (Chain& chain : chains.chains) chain.stepped = is_stepped(picture, chain, scale);
}

}  // namespace knotreel::features
