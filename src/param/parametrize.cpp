// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/param/parametrization.h"
#include "param/assemble.h"
#include "param/curves.h"
#include "param/folds.h"
#include "param/framed_mesh.h"
#include "param/multigrid.h"
#include "param/simplify.h"
#include "param/tiles.h"
#include "param/uncross.h"

namespace knotreel::param {
namespace {

/// Enough for repair_folds() to reach the whole of any picture.
constexpr int kMostRounds = 40;

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, "cannot parametrize: " + why);
}

void check(const features::FeatureChains& chains, const ParametrizeOptions& o) {
  if (chains.width < 1 || chains.height < 1) refuse("the picture has no pixels");
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (!positive(o.polyline_distance)) refuse("the distance of polylines must be positive");
  if (!std::isfinite(o.stepped_distance) || o.stepped_distance < 0)
    refuse("the distance of stepped polylines must be zero or positive");
  if (!positive(o.polyline_bulge)) refuse("the bulge of polylines must be positive");
  if (!positive(o.tolerance)) refuse("the tolerance must be positive");
  if (!std::isfinite(o.decay) || o.decay < 0) refuse("the decay must be zero or positive");
}

void check(const features::FeatureChains& chains, const features::ImageMesh& mesh) {
  const auto squares =
      static_cast<std::size_t>(chains.width - 1) * static_cast<std::size_t>(chains.height - 1);
  if (mesh.width != chains.width || mesh.height != chains.height || mesh.diagonals.size() != squares) {
    refuse("image mesh and feature chains are of different sizes");
  }
}

/// Makes polylines of curves. @return how many chains had to go.
int place(Curves& curves, const ParametrizeOptions& options, Parametrization& result) {
  int dropped = uncross(curves);
  mark_preferred(curves, options);
  simplify(curves, options);
  dropped += make_planar(curves, options);
  assemble_polylines(curves, result);
  return dropped;
}

class Parametrizer {
 public:
  Parametrizer(const features::FeatureChains& chains, const features::ImageMesh& mesh,
               const ParametrizeOptions& options)
      : mesh_(mesh), options_(options), curves_(make_curves(chains)), field_(chains.width, chains.height) {
    make_all_anew();
  }

  Parametrization run() {
    Tiles tiles(curves_.width, curves_.height);  // that may have folds
    for (int round = 0; round < kMostRounds; ++round) {
      place_curves();
      tiles.add(solve());
      const std::vector<Fold> folds = find_folds(FramedMesh(mesh_, result_), result_, tiles);
      if (round == 0) report_.folds_found = static_cast<int>(folds.size());
      report_.folds_left = static_cast<int>(folds.size());
      report_.rounds = round + 1;
      if (folds.empty()) break;
      repair_folds(curves_, folds, round);
      tiles = Tiles(curves_.width, curves_.height);
      for (const Fold& f : folds) tiles.add_cell(std::max(f.x, 0), std::max(f.y, 0));
    }
    report_.relaxed_points = static_cast<int>(std::count_if(curves_.sites.begin(), curves_.sites.end(),
                                                            [](const Site& s) { return s.fairing < 1; }));
    return std::move(result_);
  }

  const ParametrizeReport& report() const { return report_; }

 private:
  /// @return whether they were others.
  bool set(int x, int y, Vec2 position, Vec2 parameter) {
    const Vec2 centre{x + 0.5, y + 0.5};
    const Vec2 f = position - centre;
    const Vec2 d = parameter - centre;
    const Quad now{static_cast<float>(f.x), static_cast<float>(f.y), static_cast<float>(d.x),
                   static_cast<float>(d.y)};
    const Quad before = std::exchange(field_.at(x, y), now);
    return largest(now - before) != 0;
  }

  void place_curves() {
    const int dropped = place(curves_, options_, result_);
    report_.dropped_chains += dropped;
    if (dropped > 0) make_all_anew();
  }

  void make_all_anew() {
    solver_.reset();
    field_ = Framed<Quad>(curves_.width, curves_.height);
    put_layouts_at_rest(curves_, result_);
  }

  /// @return the tiles in which squares of pixels may have changed.
  Tiles solve() {
    if (result_.polylines.empty()) return {curves_.width, curves_.height};
    if (!solver_) {
      std::vector<std::uint8_t> fixed(curves_.at_pixel.size());
      std::transform(curves_.at_pixel.begin(), curves_.at_pixel.end(), fixed.begin(),
                     [](SiteIndex s) { return static_cast<std::uint8_t>(s != kNone); });
      solver_.emplace(curves_.width, curves_.height, fixed, options_.decay);
    }
    std::vector<std::int32_t> changed;
    for (const Site& s : curves_.sites) {
      if (s.pixel == kNoPixel || curves_.at_pixel[static_cast<std::size_t>(s.pixel)] == kNone) continue;
      if (set(curves_.x_of(s), curves_.y_of(s), s.position, s.parameter)) changed.push_back(s.pixel);
    }
    report_.cycles += solver_->solve(field_, options_.tolerance, changed);
    assemble_layouts(curves_, field_, solver_->touched(), result_);
    return solver_->touched().grown(1);  // squares reach over to the next tile
  }

  const features::ImageMesh& mesh_;
  const ParametrizeOptions& options_;
  Curves curves_;
  Framed<Quad> field_;  ///< not damped: what the solver left
  std::optional<ScreenedTutte> solver_;
  Parametrization result_;
  ParametrizeReport report_;
};

}  // namespace

Parametrization first_polylines(const features::FeatureChains& chains, const ParametrizeOptions& options) {
  check(chains, options);
  Curves curves = make_curves(chains);
  Parametrization result;
  result.width = chains.width;
  result.height = chains.height;
  place(curves, options, result);
  return result;
}

Parametrization parametrize(const features::FeatureChains& chains, const features::ImageMesh& mesh,
                            const ParametrizeOptions& options, ParametrizeReport* report) {
  check(chains, options);
  check(chains, mesh);
  Parametrizer parametrizer(chains, mesh, options);
  Parametrization result = parametrizer.run();
  if (report != nullptr) *report = parametrizer.report();
  return result;
}

}  // namespace knotreel::param
