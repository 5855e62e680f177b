// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/rework.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "knotreel/fit/descend.h"
#include "knotreel/fit/knot_gradient.h"
#include "knotreel/knots/idle_knots.h"
#include "knotreel/knots/long_edges.h"
#include "knotreel/knots/refine.h"
#include "knotreel/mesh/insert_polylines.h"
#include "track/births.h"
#include "track/new_knots.h"
#include "track/resting_knots.h"
#include "vectorize/feature_budget.h"

namespace knotreel::track {

namespace {

using mesh::EditableMesh;
using mesh::KnotIndex;
using mesh::KnotMesh;

constexpr double kLeastShare = 0.25;    // of what features may use, that a group without any may come to
constexpr double kRoomOfDense = 1.2;    // times what the first frame has
constexpr double kFunctionsOfKnot = 3;  // about: the least by which a group grows
constexpr double kShareOfLong = 0.25;   // of what is left of the bound, most that go where edges are long
constexpr double kBoundLeeway = 0.003;  // of the bound, that new knots leave: links that change need room too

}  // namespace

void Rework::start_group(const FittedFrame& frame) {
  is_dense_ = frame.dense;
  first_functions_ = group_functions_ = frame.space->function_count();
  group_features_ = feature_length(frame.space->mesh());
  since_births_ = 0;
  since_rework_ = options_.rework_interval;
  has_new_features_ = false;
  settling_.clear();
}

bool Rework::take_new_features() {
  return std::exchange(has_new_features_, false);
}

KnotMesh Rework::for_next_frame(const ReworkInput& input, double mec, bool urgent, const ReworkLog& log) {
  if (input.is_drawn ? input.is_missed : mec > options_.grow_above * cold_.mec) grow_group(input);
  ++since_births_;
  if (++since_rework_ < options_.rework_interval && !urgent) return input.mesh;
  since_rework_ = 0;
  return rework(input, urgent, log);
}

KnotMesh Rework::rework(const ReworkInput& input, bool urgent, const ReworkLog& log) {
  KnotMesh next = input.mesh;
  const std::vector<float> errors = squared_errors(input.frame);
  if (options_.settle) settle(input, errors, urgent, next);
  log.laps.lap("settle");
  EditableMesh mesh(next, log.next_id);
  const double functions_before = vectorize::expected_functions(mesh, cold_.degree);
  std::vector<KnotIndex> born;
  if (!urgent && !input.is_drawn) born = add_features(input, errors, mesh, log);
  log.laps.lap("births");
  refill(input, errors, urgent, mesh, born,
         vectorize::expected_functions(mesh, cold_.degree) - functions_before, log);
  log.laps.lap("refill");
  return mesh.to_mesh();
}

void Rework::settle(const ReworkInput& input, std::span<const float> errors, bool urgent, KnotMesh& mesh) {
  const FittedFrame& frame = input.frame;
  if (urgent) settling_.wake();
  const std::vector<std::uint8_t> awake =
      settling_.awake(mesh, resting_knots(mesh, input.rest), input.is_drawn);
  std::vector<Vec2> moves =
      settling_.moves(mesh, fit::knot_gradient(frame.values(), frame.seen.view(), frame.colours, awake),
                      std::accumulate(errors.begin(), errors.end(), 0.0));
  fit::limit_moves(*frame.space, input.mesh, options_.carry.min_distance, moves);
  const std::vector<Vec2> moved = fit::moved_positions(mesh, moves);
  for (std::size_t k = 0; k < moved.size(); ++k) mesh.knots[k].position = moved[k];
}

/// Features that the model lacks, where ones that got lost since the group began leave room for them.
/// @return their knots.
std::vector<KnotIndex> Rework::add_features(const ReworkInput& input, std::span<const float> errors,
                                            EditableMesh& mesh, const ReworkLog& log) {
  std::vector<KnotIndex> born;
  if (!cold_.features || options_.birth_interval < 1 || since_births_ < options_.birth_interval) return born;
  since_births_ = 0;
  const FittedFrame& frame = input.frame;
  const double least = kLeastShare * cold_.feature_share * static_cast<double>(group_functions_);
  const double room = std::max(least / vectorize::kFunctionsPerFeaturePixel, group_features_) -
                      feature_length(frame.space->mesh());
  const auto lines = missing_features(*frame.basis, frame.displacement, frame.seen, input.target.image(),
                                      errors, cold_.detect, room, options_.birth);
  for (const std::vector<KnotIndex>& knots : mesh::insert_polylines(mesh, lines)) {
    born.insert(born.end(), knots.begin(), knots.end());
    log.changes.features_born += knots.empty() ? 0 : 1;
  }
  has_new_features_ = !born.empty();
  return born;
}

/// A group gets more control points while the error is above what is asked for and the bound leaves room:
/// the content has become harder. A cold frame would have used them.
void Rework::grow_group(const ReworkInput& input) {
  if (options_.growth <= 0) return;
  std::size_t most = input.most_functions;
  if (is_dense_) {
    const auto room = static_cast<std::size_t>(kRoomOfDense * static_cast<double>(first_functions_));
    most = std::min(most, room);
  }
  const double more = std::max(kFunctionsOfKnot, options_.growth * static_cast<double>(group_functions_));
  const std::size_t grown = group_functions_ + static_cast<std::size_t>(more);
  group_functions_ = std::max(group_functions_, std::min(grown, most));
}

/// By how much a dense group has more features now than at its start: what is around them asks for more
/// knots, too. Others may use all of their bound.
double Rework::richer(const FittedFrame& frame) const {
  if (!is_dense_ || group_features_ <= 0) return 1;
  return std::max(1.0, feature_length(frame.space->mesh()) / group_features_);
}

/// Puts knots where the error is: as many as got lost, and those that are idle elsewhere.
void Rework::refill(const ReworkInput& input, std::span<const float> errors, bool urgent, EditableMesh& mesh,
                    const std::vector<KnotIndex>& born, double born_functions, const ReworkLog& log) const {
  const FittedFrame& frame = input.frame;
  const int width = input.target.image().width, height = input.target.image().height;
  const double functions = static_cast<double>(frame.space->function_count());
  const double per_knot = functions / static_cast<double>(frame.space->mesh().knots.size());
  const double wanted = std::min(richer(frame) * static_cast<double>(group_functions_),
                                 (1 - kBoundLeeway) * static_cast<double>(input.most_functions));
  double missing = (wanted - functions - born_functions) / per_knot;
  // Features come and go there, and what they leave need not be filled.
  if (input.is_drawn && !input.is_missed) missing = std::min(missing, 0.0);
  knots::SwapOptions swap = urgent ? options_.urgent_swap : options_.swap;
  if (input.is_drawn) swap.longest_edge = options_.drawn->longest_edge;
  const std::size_t removed = knots::remove_idle_knots(
      mesh, input.target, knots::sorted_face_errors(mesh, errors, width, height), swap,
      born.empty() && !input.is_drawn ? 0 : static_cast<std::size_t>(std::max(0.0, -missing)));
  log.changes.swapped += removed;
  knots::RefineOptions refine;
  refine.max_knots = static_cast<std::size_t>(std::max(0.0, missing + static_cast<double>(removed)));
  refine.min_distance = options_.carry.min_distance;
  std::vector<KnotIndex> fresh =
      knots::refine_knots(mesh, errors, frame.seen.placed->places(), width, height, refine);
  if (swap.longest_edge > 0) {
    const double room = static_cast<double>(input.most_functions) - functions;
    log.changes.inserted += knots::split_long_edges(
        mesh, swap.longest_edge, static_cast<std::size_t>(std::max(0.0, kShareOfLong * room / per_knot)));
  }
  log.changes.inserted += fresh.size();
  fresh.insert(fresh.end(), born.begin(), born.end());
  log.next_id = mesh.next_id();
  optimise_new_knots(mesh, fresh, input.target, cold_, options_);
}

}  // namespace knotreel::track
