// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/find_curves.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "knotreel/features/chain_order.h"
#include "knotreel/image/enlarge.h"
#include "knotreel/image/same_cells.h"
#include "vectorize/feature_budget.h"

namespace knotreel::vectorize {

namespace {

using features::CellMask;
using features::FeatureChains;

CurveRules rules_of(const Options& options, int scale) {
  return {.scale = scale,
          .features = options.features,
          .fairing = options.fairing,
          .corner_detection = options.corner_detection,
          .max_turning = options.max_turning,
          .detect = detect_options(options, true),
          .fair = options.fair,
          .corners = options.corners};
}

/// Cells of the grid with pixels that are not the same, bit for bit. @param scale of the grid.
CellMask changed_cells(const image::Image& a, const image::Image& b, int scale) {
  CellMask changed(scale * a.width, scale * a.height, false);
  const std::vector<std::uint8_t> same = image::same_cells(a, b, CellMask::kSide / scale);
  for (int row = 0, i = 0; row < changed.rows(); ++row) {
    for (int column = 0; column < changed.columns(); ++column, ++i)
      changed.set(column, row, same[std::size_t(i)] == 0);
  }
  return changed;
}

/// Where features are found anew.
struct Parts {
  CellMask cells;
  std::vector<PixelBox> windows;  ///< with all that these hang on
};

Parts everywhere(const image::Image& picture, int scale) {
  const int width = scale * picture.width;
  const int height = scale * picture.height;
  return {CellMask(width, height, true), {{0, 0, width, height}}};
}

/// Edges are where they were, or where pixels have changed. All that may have to do with one of the latter is
/// found anew.
Parts where_changed(const KnownCurves& known, const image::Image& picture) {
  const int scale = known.rules.scale;
  // An enlarged pixel is one of two, whose other one may be further away.
  const int of_enlarging = scale > 1 ? scale * image::kReachOfEnlarging + 1 : 0;
  const int reach = features::reach_of_edges(known.rules.detect) + of_enlarging;
  const int cells = (reach + CellMask::kSide - 1) / CellMask::kSide;
  const CellMask touched = changed_cells(known.picture, picture, scale).wider(cells);
  const features::Reached reached = features::reach(touched, known.edges, features::kEdgesApart);
  std::vector<PixelBox> windows = features::windows_around(
      reached.boxes, (features::kEdgesApart + cells) * CellMask::kSide, touched.width(), touched.height());
  return {reached.cells.wider(1), std::move(windows)};
}

/// The pixels of a window of the grid. @param picture the original.
image::Image part_of(const image::Image& picture, const PixelBox& window, int scale) {
  image::Image part = image::make_image(window.width() / scale, window.height() / scale, picture.channels);
  const std::size_t from = std::size_t(window.left / scale) * std::size_t(picture.channels);
  for (int y = 0; y < part.height; ++y)
    std::ranges::copy(picture.row(window.top / scale + y).subspan(from, part.row_size()),
                      part.row(y).begin());
  return scale == 1 ? part : image::enlarge_twofold(part);
}

/// @param edges brought up to date in these parts.
FeatureChains detect(const image::Image& picture, const Parts& parts, const CurveRules& rules,
                     CellMask& edges) {
  FeatureChains found{parts.cells.width(), parts.cells.height(), {}, 0};
  for (const PixelBox& window : parts.windows) {
    FeatureChains here = features::detect_in_window(part_of(picture, window, rules.scale), window,
                                                    rules.detect, parts.cells, edges);
    std::ranges::move(here.chains, std::back_inserter(found.chains));
  }
  features::sort_as_found(found);
  features::number_nodes({&found});
  features::mark_stepped(picture, found);
  return found;
}

/// Adds the known chains that are nowhere in these cells.
void add_kept(const FeatureChains& known, const CellMask& anew, FeatureChains& chains) {
  for (const features::Chain& chain : known.chains) {
    if (!anew.at_pixel(chain.points.front().x, chain.points.front().y)) chains.chains.push_back(chain);
  }
  features::sort_as_found(chains);
}

}  // namespace

bool same_size(const image::Image& a, const image::Image& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels;
}

KnownCurves find_curves(const image::Image& picture, int scale, const Options& options,
                        features::KnownCorners& corners, const KnownCurves* known) {
  image::check_image(picture);
  KnownCurves result;
  result.picture = picture;
  result.rules = rules_of(options, scale);
  if (!options.features) return result;
  if (known && (known->rules != result.rules || !same_size(known->picture, picture))) known = nullptr;
  const Parts parts = known ? where_changed(*known, picture) : everywhere(picture, scale);
  result.edges = known ? known->edges : parts.cells;
  FeatureChains& detected = result.curves.detected;
  detected = detect(picture, parts, result.rules, result.edges);
  result.winding = {detected.width, detected.height, {}, detected.node_count};
  if (options.max_turning > 0) result.winding = drop_winding(options.max_turning, detected);
  result.curves.faired = faired_curves(picture, detected, options, corners);
  if (!known) return result;
  add_kept(known->winding, parts.cells, result.winding);
  add_kept(known->curves.detected, parts.cells, detected);
  add_kept(known->curves.faired, parts.cells, result.curves.faired);
  features::number_nodes({&result.winding, &detected, &result.curves.faired});
  return result;
}

}  // namespace knotreel::vectorize
