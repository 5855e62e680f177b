// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/drawn_features.h"

#include <utility>

#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/fit/geometry_fit.h"
#include "track/bend_geometry.h"
#include "vectorize/fine_grid.h"
#include "vectorize/run_log.h"
#include "vectorize/samples.h"

namespace knotreel::track {
namespace {

// Of the shares of features: so much more until the first are left out, and less until they are back.
constexpr double kSlack = 0.3;

// Curves go where they were found, and what is around them gives way.
constexpr Sheet kYielding{.stiffness = 0, .elasticity = 0.03, .inertia = 0.001};

features::SecondDifferences differences_of(const image::Image& picture, const KnownDrawing* known) {
  if (!known || !vectorize::same_size(known->curves.picture, picture))
    return features::SecondDifferences(picture);
  return {picture, known->curves.picture, known->differences};
}

}  // namespace

std::shared_ptr<const DrawnCurves> find_drawn_curves(const image::Image& picture,
                                                     const vectorize::Options& drawn, Drawing how,
                                                     std::shared_ptr<KnownDrawings> known) {
  DrawnCurves curves;
  curves.known = known ? std::move(known) : std::make_shared<KnownDrawings>();
  // Any other picture does, whichever was done last.
  const std::shared_ptr<const KnownDrawing> before = curves.known->last();
  KnownDrawing now;
  now.differences = differences_of(picture, before.get());
  if (!features::may_be_drawing(picture, now.differences)) {
    curves.known->keep(nullptr);
    return nullptr;
  }
  curves.fine_grid = how == Drawing::kFineGrid;
  vectorize::Options options = vectorize::suited_to(picture, now.differences, drawn);
  if (curves.fine_grid) options = vectorize::on_fine_grid(options);
  now.curves = vectorize::find_curves(picture, curves.fine_grid ? 2 : 1, options, curves.known->corners(),
                                      before ? &before->curves : nullptr);
  curves.found = now.curves.curves;
  curves.known->keep(std::make_shared<const KnownDrawing>(std::move(now)));
  return std::make_shared<const DrawnCurves>(std::move(curves));
}

DrawnFeatures::DrawnFeatures(const image::Image& picture, const vectorize::Options& options,
                             const DrawnCurves& curves, std::size_t most_functions,
                             std::span<const Vec2> vertices, const FeatureLimits& before) {
  const auto slack = [](bool dropped) { return dropped ? 1 - kSlack : 1 + kSlack; };
  vectorize::Options limited = curves.fine_grid ? vectorize::on_fine_grid(options) : options;
  limited.feature_share = slack(before.strong_dropped) * before.share;
  limited.drawn_weak_share *= slack(before.weak_dropped);
  const vectorize::Observer nobody;
  vectorize::RunLog log(picture, nobody);
  log.begin_round("features");
  std::vector<Vec2> on_grid(vertices.begin(), vertices.end());
  if (curves.fine_grid) {
    for (Vec2& v : on_grid) v = 2.0 * v;
  }
  is_sound_ = vectorize::map_curves(picture, limited, most_functions, curves.found, on_grid,
                                    curves.known->corners(), log, mapped_);
  limits_ = {before.share, log.report.chains_over_budget > 0, mapped_.dropped.strong, curves.fine_grid};
  if (curves.fine_grid && is_sound_) mapped_ = vectorize::halved_features(mapped_);
}

std::vector<Vec2> DrawnFeatures::displacement(const spline::Basis& basis, double unfold, double step) const {
  std::vector<Vec2> displacement(basis.space().geometry_count());
  bend_geometry(basis, vectorize::curve_points(mapped_), displacement, {}, kYielding);
  document::round_displacement(displacement, step);
  fit::unfold_geometry(basis, displacement, unfold);
  document::round_displacement(displacement, step);
  return displacement;
}

}  // namespace knotreel::track
