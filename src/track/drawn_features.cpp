#include "track/drawn_features.h"

#include "knotreel/document/stored_mesh.h"
#include "knotreel/fit/geometry_fit.h"
#include "vectorize/run_log.h"
#include "vectorize/feature_budget.h"

namespace knotreel::track {
namespace {

// Of the shares of features: so much more until the first are left out, and less until they are back.
constexpr double kSlack = 0.3;

}  // namespace

DrawnFeatures::DrawnFeatures(const image::Image& picture, const vectorize::Options& options,
                             std::size_t most_functions, const FeatureLimits& before)
    : options_(options) {
  const auto slack = [](bool dropped) { return dropped ? 1 - kSlack : 1 + kSlack; };
  options_.feature_share = slack(before.strong_dropped) * before.share;
  options_.drawn_weak_share *= slack(before.weak_dropped);
  const vectorize::Observer nobody;
  vectorize::RunLog log(picture, nobody);
  log.begin_round("features");
  vectorize::map_features(picture, options_, most_functions, log, mapped_);
  if (getenv("DBG")) fprintf(stderr, "chains %zu dropped %zu strong %d before %d %d functions of mesh %.0f\n", log.report.chains, log.report.chains_over_budget, mapped_.over_share, before.weak_dropped, before.strong_dropped, vectorize::expected_functions(mesh::EditableMesh(mapped_.knots), 2));
  limits_ = {before.share, log.report.chains_over_budget > 0, mapped_.over_share};
  samples_ = std::make_unique<vectorize::Samples>(picture, mapped_, false);
}

std::vector<Vec2> DrawnFeatures::displacement(const spline::Basis& basis, double step) const {
  const image::Image& picture = samples_->picture();
  const spline::PixelValues values(basis, picture.width, picture.height, samples_->places());
  std::vector<Vec2> result =
      fit::fit_geometry(values, samples_->places(), samples_->curves(), options_.geometry);
  document::round_displacement(result, step);
  fit::unfold_geometry(basis, result, options_.unfold);
  document::round_displacement(result, step);
  return result;
}

}  // namespace knotreel::track
