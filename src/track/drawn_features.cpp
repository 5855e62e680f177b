#include "track/drawn_features.h"

#include "knotreel/document/stored_mesh.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/fit/geometry_fit.h"
#include "track/bend_geometry.h"
#include "vectorize/run_log.h"
#include "vectorize/samples.h"

namespace knotreel::track {
namespace {

// Of the shares of features: so much more until the first are left out, and less until they are back.
constexpr double kSlack = 0.3;

// Curves go where they were found, and what is around them gives way.
constexpr Sheet kYielding{.stiffness = 0, .elasticity = 0.03, .inertia = 0.001};

}  // namespace

std::shared_ptr<const DrawnCurves> find_drawn_curves(const image::Image& picture,
                                                     const vectorize::Options& drawn) {
  if (!features::is_drawing(picture)) return nullptr;
  return std::make_shared<const DrawnCurves>(DrawnCurves{vectorize::find_curves(picture, drawn)});
}

DrawnFeatures::DrawnFeatures(const image::Image& picture, const vectorize::Options& options,
                             const DrawnCurves& curves, std::size_t most_functions,
                             std::span<const Vec2> vertices, const FeatureLimits& before) {
  const auto slack = [](bool dropped) { return dropped ? 1 - kSlack : 1 + kSlack; };
  vectorize::Options limited = options;
  limited.feature_share = slack(before.strong_dropped) * before.share;
  limited.drawn_weak_share *= slack(before.weak_dropped);
  const vectorize::Observer nobody;
  vectorize::RunLog log(picture, nobody);
  log.begin_round("features");
  is_sound_ = vectorize::map_curves(picture, limited, most_functions, curves.found, vertices, log, mapped_);
  limits_ = {before.share, log.report.chains_over_budget > 0, mapped_.over_share};
}

void DrawnFeatures::displace(const spline::Basis& basis, std::span<const std::uint8_t> held, double unfold,
                             double step, std::vector<Vec2>& displacement) const {
  for (std::size_t g = 0; g < displacement.size(); ++g) {
    if (held.empty() || !held[g]) displacement[g] = {};
  }
  bend_geometry(basis, vectorize::curve_points(mapped_), displacement, held, kYielding);
  document::round_displacement(displacement, step);
  fit::unfold_geometry(basis, displacement, unfold);
  document::round_displacement(displacement, step);
}

}  // namespace knotreel::track
