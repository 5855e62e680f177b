// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/settle.h"

#include <algorithm>

#include "knotreel/mesh/edge_lengths.h"

namespace knotreel::track {

namespace {

// Factors of a step while the direction stays, and when it turns.
constexpr double kGrow = 1.35;
constexpr double kShrink = 0.6;
constexpr double kLongest = 0.1;  // share of the shortest edge

}  // namespace

std::vector<std::uint8_t> Settling::awake(const mesh::KnotMesh& mesh, std::span<const std::uint8_t> resting,
                                          bool at_once) const {
  std::vector<std::uint8_t> result(mesh.knots.size(), 1);
  for (std::size_t k = 0; k < result.size(); ++k) {
    const auto known = steps_.find(static_cast<std::uint32_t>(mesh.knots[k].id));
    const bool has_settled = known != steps_.end() && known->second.settled;
    const bool naps = known != steps_.end() && known->second.nap > 0;
    result[k] = naps || (resting[k] && (has_settled || at_once)) ? 0 : 1;
  }
  return result;
}

void Settling::wake() {
  for (auto& [id, step] : steps_) step.nap = 0;
}

std::vector<Vec2> Settling::moves(const mesh::KnotMesh& mesh, const std::vector<Vec2>& gradient,
                                  double error) {
  const std::vector<double> shortest = mesh::shortest_edges(mesh);
  std::unordered_map<std::uint32_t, Step> steps;
  const double least_gain = options_.least_gain * error / static_cast<double>(gradient.size());
  std::vector<Vec2> result(gradient.size());
  for (std::size_t k = 0; k < gradient.size(); ++k) {
    const auto id = static_cast<std::uint32_t>(mesh.knots[k].id);
    const auto known = steps_.find(id);
    if (known != steps_.end() && known->second.nap > 0) {
      --known->second.nap;
      steps.insert(*known);
      continue;
    }
    const double size = norm(gradient[k]);
    if (!(size > 0)) {
      if (known != steps_.end()) steps.insert(*known);
      continue;
    }
    Step step = known != steps_.end() ? known->second : Step{options_.first_step * shortest[k], {}};
    const Vec2 direction = (-1 / size) * gradient[k];
    const double turn = dot(direction, step.direction);
    step.length *= turn > 0.5 ? kGrow : turn < 0 ? kShrink : 1.0;
    step.length = std::min(step.length, kLongest * shortest[k]);
    step.direction = direction;
    if (size * step.length >= least_gain && step.length >= options_.least) {
      result[k] = step.length * direction;
      step.settled = false;
    } else {
      step.nap = options_.nap;
      step.settled = true;
    }
    steps.emplace(id, step);
  }
  steps_ = std::move(steps);
  return result;
}

}  // namespace knotreel::track
