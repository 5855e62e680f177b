// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/folds.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "knotreel/base/parallel.h"
#include "param/simplify.h"

namespace knotreel::param {
namespace {

/// Smallest area, in square pixels, of a triangle with a vertex off the features; at rest it is 0.5.
constexpr double kLeastArea = 1e-3;
/// Of three feature pixels: zero but for rounding.
constexpr double kLeastFeatureArea = -1e-6;
constexpr int kGentleRounds = 4;
constexpr int kGentleRadius = 2;  // pixels

bool is_folded(const FramedMesh& mesh, const FramedMesh::Layout& layout, const FramedMesh::Triangle& t) {
  const double area = signed_area(mesh.vertex(layout, t[0].x, t[0].y), mesh.vertex(layout, t[1].x, t[1].y),
                                  mesh.vertex(layout, t[2].x, t[2].y));
  if (area >= kLeastArea) return false;
  const bool on_features = std::all_of(
      t.begin(), t.end(), [&](FramedMesh::Corner c) { return mesh.is_feature(mesh.pixel(c.x, c.y)); });
  return !on_features || area < kLeastFeatureArea;
}

/// Counts of folds in boxes of squares. Sums over all folds and radii would take hours where a radius covers
/// the picture and the folds do too.
class FoldCounts {
 public:
  FoldCounts(const Curves& curves, const std::vector<Fold>& folds, bool in_parameter)
      : columns_(curves.width + 1), rows_(curves.height + 1) {
    sums_.assign(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1), 0);
    for (const Fold& f : folds) {
      if (f.in_parameter == in_parameter) ++sums_[index(f.x + 2, f.y + 2)];  // squares begin at -1
    }
    for (int y = 1; y <= rows_; ++y) {
      for (int x = 1; x <= columns_; ++x) {
        sums_[index(x, y)] += sums_[index(x - 1, y)] + sums_[index(x, y - 1)] - sums_[index(x - 1, y - 1)];
      }
    }
  }

  /// Whether a fold has its square within a radius of a pixel.
  bool any_near(int x, int y, int radius) const {
    const int x0 = std::max(0, x - radius);
    const int y0 = std::max(0, y - radius);
    const int x1 = std::min(columns_, x + radius + 2);
    const int y1 = std::min(rows_, y + radius + 2);
    return sums_[index(x1, y1)] - sums_[index(x0, y1)] - sums_[index(x1, y0)] + sums_[index(x0, y0)] > 0;
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_ + 1) + static_cast<std::size_t>(x);
  }

  int columns_;
  int rows_;
  std::vector<std::int64_t> sums_;
};

std::vector<SiteIndex> sites_near(const Curves& curves, const std::vector<Fold>& folds, int radius,
                                  bool in_parameter) {
  const FoldCounts counts(curves, folds, in_parameter);
  std::vector<SiteIndex> near;
  for (SiteIndex s = 0; s < curves.sites.size(); ++s) {
    const Site& site = curves.sites[s];
    if (site.pixel == kNoPixel || curves.at_pixel[static_cast<std::size_t>(site.pixel)] == kNone) continue;
    if (counts.any_near(curves.x_of(site), curves.y_of(site), radius)) near.push_back(s);
  }
  return near;
}

}  // namespace

std::vector<Fold> find_folds(const FramedMesh& mesh, const Parametrization& parametrization,
                             const Tiles& tiles) {
  std::vector<std::vector<Fold>> of_row(static_cast<std::size_t>(mesh.height()) + 1);
  parallel_for(of_row.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row) - 1;
    const bool on_border = y < 0 || y + 1 == mesh.height();
    for (int x = -1; x < mesh.width(); ++x) {
      if (!on_border && x >= 0 && x + 1 < mesh.width() && !tiles.has_cell(x, y)) continue;
      for (const FramedMesh::Triangle& t : mesh.triangles(x, y)) {
        if (is_folded(mesh, parametrization.position, t)) of_row[row].push_back({x, y, false});
        if (is_folded(mesh, parametrization.parameter, t)) of_row[row].push_back({x, y, true});
      }
    }
  });
  std::vector<Fold> folds;
  for (const auto& row : of_row) folds.insert(folds.end(), row.begin(), row.end());
  return folds;
}

void repair_folds(Curves& curves, const std::vector<Fold>& folds, int round) {
  if (round < kGentleRounds) {
    const auto position_sites = sites_near(curves, folds, kGentleRadius + round, false);
    const auto parameter_sites = sites_near(curves, folds, kGentleRadius + round, true);
    const bool split = split_segments_of(curves, parameter_sites);
    for (const SiteIndex s : position_sites) relax(curves.sites[s]);
    if (!split) {
      for (const SiteIndex s : parameter_sites) relax(curves.sites[s]);
    }
    return;
  }
  const int radius = std::min(4 << std::min(round - kGentleRounds, 20), curves.width + curves.height);
  for (const bool in_parameter : {false, true}) {
    for (const SiteIndex s : sites_near(curves, folds, radius, in_parameter)) {
      set_fairing(curves.sites[s], 0);
      curves.sites[s].is_vertex = true;
    }
  }
}

}  // namespace knotreel::param
