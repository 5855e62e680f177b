// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/rounds.h"

#include <algorithm>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/idle_knots.h"
#include "knotreel/knots/link_choice.h"
#include "knotreel/knots/refine.h"
#include "vectorize/clear_tangents.h"
#include "vectorize/first_knots.h"

namespace knotreel::vectorize {

using mesh::EditableMesh;
using mesh::KnotIndex;

namespace {

// Of idle knots in a round of refinement: more go at once than in a video, where each change is seen.
constexpr knots::SwapOptions kSwap{.ratio = 10, .share = 0.1};

// Of the knots that fit into the bound: how many functions each brings is a guess.
constexpr double kShareOfWanted = 0.98;

// Of the knots, as many more at most make room for curves.
constexpr double kShareBesideCurves = 0.2;

}  // namespace

void Rounds::first(EditableMesh mesh, mesh::KnotMesh& knots) {
  mesh_ = std::make_unique<EditableMesh>(std::move(mesh));
  settle_first_knots(knots);
  fit(options_.rounds == 1);
}

bool Rounds::next(int round, const std::vector<float>& left_out) {
  if (!refine(round, left_out)) return false;
  fit(round == options_.rounds);
  return true;
}

void Rounds::settle_first_knots(mesh::KnotMesh& knots) {
  knots::optimise(*mesh_, target_, options_.optimise);
  log_.lap("optimise");
  // Where there are few knots, those of slivers were what held the error down.
  if (options_.optimise.connectivity && knots::remove_slivers(*mesh_, target_, options_.optimise) > 0)
    insert_first_knots(target_, max_functions_, options_, *mesh_);
  log_.lap("slivers");
  knots = mesh_->to_mesh();
  log_.progress.knot_mesh = &knots;
  log_.show("knots");
}

/// Inserts knots where the last fit was worst, and moves there those that are idle elsewhere. @return whether
/// there were any.
bool Rounds::refine(int round, const std::vector<float>& left_out) {
  const int left = options_.rounds - round + 1;
  const spline::SplineSpace& space = *draft_.surface.space;
  const double used = static_cast<double>(space.function_count());
  const double budget = used + (static_cast<double>(max_functions_) - used) / left;
  const double per_knot = used / static_cast<double>(space.mesh().knots.size());
  const double wanted = std::max(0.0, (budget - used) / per_knot);
  knots::RefineOptions refine;
  refine.max_knots = static_cast<std::size_t>(kShareOfWanted * wanted);
  refine.min_distance = options_.optimise.min_distance;
  mesh_ = std::make_unique<EditableMesh>(space.mesh());
  std::vector<KnotIndex> inserted = refine_curves();
  curves_refined_ = !inserted.empty();
  refine.max_knots -= std::min(refine.max_knots, inserted.size());
  const image::Image& picture = samples_.picture();
  std::vector<float> of_all;
  if (left_out.empty()) {
    of_all = squared_errors(samples_, draft_);
    refine.max_knots += knots::remove_idle_knots(
        *mesh_, target_, knots::sorted_face_errors(*mesh_, of_all, picture.width, picture.height), kSwap);
  }
  const std::vector<float>& errors = left_out.empty() ? of_all : left_out;
  const std::vector<KnotIndex> off_curves =
      knots::refine_knots(*mesh_, errors, samples_.places(), picture.width, picture.height, refine);
  inserted.insert(inserted.end(), off_curves.begin(), off_curves.end());
  log_.lap("insert");
  if (inserted.empty()) return false;
  knots::OptimiseOptions local = options_.optimise;
  local.rounds = std::min(local.rounds, 1);  // most of the mesh is as good as it gets
  knots::optimise(*mesh_, target_, local, knots::rings_around(*mesh_, inserted, 2));
  log_.lap("optimise");
  return true;
}

/// Knots on features, where the geometry misses the curves by more than a pixel.
std::vector<KnotIndex> Rounds::refine_curves() {
  if (!curves_refined_) return {};  // the errors are those of an earlier round
  std::vector<knots::CurveError> errors;
  for (std::size_t i = 0; i < draft_.curve_errors.size(); ++i) {
    errors.push_back({samples_.curve_segments()[i], samples_.curves()[i].parameter, draft_.curve_errors[i]});
  }
  return knots::refine_features(*mesh_, errors, std::max(1.0, options_.meg), options_.optimise.min_distance);
}

void Rounds::make_space(bool last_round) {
  mesh::KnotMesh mesh = mesh_->to_mesh();
  draft_.surface.space =
      options_.picture_links && last_round
          ? std::make_shared<const spline::SplineSpace>(
                std::move(mesh), options_.degree, knots::picture_links(target_), spline::LinkOrder::kAny)
          : std::make_shared<const spline::SplineSpace>(std::move(mesh), options_.degree);
}

/// Takes away the knots inserted last until the bound on the control points holds.
void Rounds::keep_bound(bool last_round) {
  while (draft_.surface.space->function_count() > max_functions_) {
    const std::size_t excess = draft_.surface.space->function_count() - max_functions_;
    // A knot takes two or three functions with it; to build the space once more costs more than a few knots.
    const std::size_t knots = excess / 2 + 4;
    std::size_t left = knots;
    for (std::size_t k = mesh_->knot_slots(); k-- > 0 && left > 0;) {
      if (mesh_->is_knot(static_cast<KnotIndex>(k)) && mesh_->remove(static_cast<KnotIndex>(k))) --left;
    }
    if (left == knots) return;  // no free knot is left
    make_space(last_round);
  }
}

void Rounds::fit(bool last_round) {
  if (samples_.has_features() && options_.clear_curves) {
    clear_tangents(*mesh_, target_, samples_.curves(), samples_.curve_segments(), options_.clear_inside,
                   static_cast<std::size_t>(kShareBesideCurves * static_cast<double>(mesh_->knot_count())),
                   options_.optimise.min_distance);
    log_.lap("tangents");
  }
  make_space(last_round);
  keep_bound(last_round);
  log_.lap("links");
  draft_.steering.reset();
  draft_.steering = std::make_unique<const fit::SpaceAtPixels>(draft_.surface.space, samples_.steering());
  draft_.displacement.assign(draft_.surface.space->geometry_count(), Vec2{});
  // Only knots on curves change how well the geometry follows them, and only further rounds ask for that.
  const bool has_geometry = samples_.has_features() && curves_refined_ && !last_round;
  const image::Image& picture = samples_.picture();
  // Neither needs the other, and a good part of each has one thread only.
  parallel_invoke(
      [&] {
        draft_.surface.fit = fit::fit_colours(draft_.steering->values, samples_.steering(), options_.colour);
      },
      [&] {
        if (!has_geometry) return;
        const spline::PixelValues values(draft_.steering->basis, picture.width, picture.height,
                                         samples_.places());
        fit_geometry(values, samples_, options_.geometry, draft_);
      });
  draft_.fits_all_pixels = false;
  log_.lap(has_geometry ? "geometry and colours" : "colours");
}

}  // namespace knotreel::vectorize
